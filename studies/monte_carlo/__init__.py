"""One controller on many machines of one kind: what it is worth as parameters vary."""

from .monte_carlo import MonteCarlo, monte_carlo

__all__ = ["MonteCarlo", "monte_carlo"]

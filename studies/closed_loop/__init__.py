"""Controllers played on plants: rollouts, scores, the optimal bound, comparisons."""

from .closed_loop import Loop, closed_loop, regulator

__all__ = ["Loop", "closed_loop", "regulator"]

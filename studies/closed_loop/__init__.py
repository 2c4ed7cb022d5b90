"""Controllers played on plants: rollouts, scores, the optimal bound, comparisons."""

from .closed_loop import Following, Loop, closed_loop, regulator

__all__ = ["Following", "Loop", "closed_loop", "regulator"]

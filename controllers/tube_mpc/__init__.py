"""Predictive control that keeps its limits under bounded disturbances: tubes about a plan, limits tightened by them."""

from .disturbance_set import DisturbanceSet
from .tube_mpc import TubeMPC

__all__ = ["DisturbanceSet", "TubeMPC"]

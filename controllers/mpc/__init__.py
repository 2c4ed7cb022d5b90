"""Linear model predictive control: about a goal and along a nominal motion."""

from .mpc import MPC

__all__ = ["MPC"]

"""Controllers: everything with act(t, y) -> u."""

if __name__ != "pliant.controllers":
    raise ImportError("this folder is installed as pliant.controllers: write `import pliant.controllers`")

from . import riccati, rl
from .computed_torque import ComputedTorque
from .controller import Controller, Feedback
from .lqr import LQR
from .objective import Objective
from .pd import PD
from .policy import Policy
from .shaping import Shaper, shape, shaper_for

__all__ = [
    "LQR",
    "PD",
    "ComputedTorque",
    "Controller",
    "Feedback",
    "Objective",
    "Policy",
    "Shaper",
    "riccati",
    "rl",
    "shape",
    "shaper_for",
]

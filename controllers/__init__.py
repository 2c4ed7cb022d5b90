"""Controllers: everything with act(t, y) -> u."""

if __name__ != "pliant.controllers":
    raise ImportError("this folder is installed as pliant.controllers: write `import pliant.controllers`")

from . import riccati, rl, sensors
from .computed_torque import ComputedTorque
from .controller import Controller, Feedback
from .delay import Predictive, delayed
from .loops import loop
from .lqg import LQG
from .lqr import LQR
from .margins import Margins, margins
from .mpc import MPC
from .nmpc import NMPC
from .objective import Objective
from .observer import Kalman
from .optimal import Motion, optimal
from .pd import PD
from .plan import plan
from .policy import Policy
from .sensors import Sensor, sensors_of
from .shaping import Shaper, shape, shaper_for
from .spillover import Spillover, spillover
from .tvlqr import TVLQR

__all__ = [
    "LQG",
    "LQR",
    "MPC",
    "NMPC",
    "PD",
    "TVLQR",
    "ComputedTorque",
    "Controller",
    "Feedback",
    "Kalman",
    "Margins",
    "Motion",
    "Objective",
    "Policy",
    "Predictive",
    "Sensor",
    "Shaper",
    "Spillover",
    "delayed",
    "loop",
    "margins",
    "optimal",
    "plan",
    "riccati",
    "rl",
    "sensors",
    "sensors_of",
    "shape",
    "shaper_for",
    "spillover",
]

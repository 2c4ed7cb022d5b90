"""Controllers: everything with act(t, y) -> u."""

if __name__ != "pliant.controllers":
    raise ImportError("this folder is installed as pliant.controllers: write `import pliant.controllers`")

from . import riccati, rl
from .controller import Controller, Feedback
from .lqr import LQR
from .policy import Policy

__all__ = ["LQR", "Controller", "Feedback", "Policy", "riccati", "rl"]

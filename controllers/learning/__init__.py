"""Training of policies (needs torch, imported when a run starts) and policies (NumPy only)."""

from .evaluation import Evaluation, Training, evaluate, read_curve
from .policy import Policy
from .settings import CURVE, POLICY, PPOSettings, SACSettings
from .train import train

__all__ = [
    "CURVE",
    "POLICY",
    "Evaluation",
    "PPOSettings",
    "Policy",
    "SACSettings",
    "Training",
    "evaluate",
    "read_curve",
    "train",
]

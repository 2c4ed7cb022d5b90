"""Training of policies (needs torch, imported when a run starts) and policies (NumPy only)."""

from .evaluation import Evaluation, Training, evaluate, read_curve
from .policy import Policy
from .settings import CURVE, POLICY, APGSettings, PPOSettings, SACSettings
from .train import train

__all__ = [
    "CURVE",
    "POLICY",
    "APGSettings",
    "Evaluation",
    "PPOSettings",
    "Policy",
    "SACSettings",
    "Training",
    "evaluate",
    "read_curve",
    "train",
]

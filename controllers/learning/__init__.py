"""Training of policies (needs torch, imported when a run starts) and policies (NumPy only)."""

from .policy import Policy
from .train import Evaluation, PPOSettings, SACSettings, Training, evaluate, train

__all__ = ["Evaluation", "PPOSettings", "Policy", "SACSettings", "Training", "evaluate", "train"]

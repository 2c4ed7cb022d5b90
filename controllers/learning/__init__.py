"""Training of policies (needs torch, imported when a run starts) and policies (NumPy only)."""

from .evaluation import Evaluation, Training, evaluate
from .policy import Policy
from .settings import PPOSettings, SACSettings
from .train import train

__all__ = ["Evaluation", "PPOSettings", "Policy", "SACSettings", "Training", "evaluate", "train"]

"""Lanes whose machines are models of different fidelity, drawn anew for each episode."""

from .mixed_starts import MixedStarts
from .mixed_step import MixedStep
from .mixture import Mixture

__all__ = ["MixedStarts", "MixedStep", "Mixture"]

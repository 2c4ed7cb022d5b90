"""The perturbation model of "Equations of Motion of Flexible Spacecraft" and its misprints: verification only."""

from .perturbation import RigidNominal, perturbation

__all__ = ["RigidNominal", "perturbation"]

"""LargeDeflectionBeam: exact rotations (strain) and chains of sub-beams, in the plane and in space."""

from .large_beam import LargeDeflectionBeam
from .transfer_matrices import TransferMatrices

__all__ = ["LargeDeflectionBeam", "TransferMatrices"]

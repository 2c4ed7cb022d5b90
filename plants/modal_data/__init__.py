"""Flexible bodies as modal integrals: from nodes, beams, panels, M and K, NASTRAN."""

from .modal_data import ModalData

__all__ = ["ModalData"]

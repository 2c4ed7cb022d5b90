"""The paper's letters N, Y, E, Z, C for the integrals of a body's modes.

Source   "Equations of Motion of Flexible Spacecraft", Eqs (10)-(13) and (24). The lower triangle of (12) is
         -phi_2k phi_1l, -phi_3k phi_1l, -phi_3k phi_2l, which makes E_kl the transpose of E_lk; (13) is right with it.
"""

from __future__ import annotations

import numpy as np

from pliant.plants.modal_data.integrals import axial
from pliant.plants.modal_data.modal_data import ModalData

Array = np.ndarray


def N(data: ModalData) -> Array:
    """Eq (10), int [(r . phi_k) 1 - r phi_k^T] dm (n, 3, 3) [kg m]."""
    return C(data)[:, None, None] * np.eye(3) - data.moments


def Y(data: ModalData) -> Array:
    """Eq (11), int r x phi_k dm (n, 3) [kg m]."""
    return axial(data.moments)


def E(overlaps: Array) -> Array:
    """Eq (12) corrected, int [(phi_k . phi_l) 1 - phi_k phi_l^T] dm (n, n, 3, 3) [kg] from int phi_k phi_l^T dm."""
    return np.einsum("klii->kl", overlaps)[:, :, None, None] * np.eye(3) - overlaps


def Z(overlaps: Array) -> Array:
    """Eq (13), int phi_l x phi_k dm (n, n, 3) [kg]: opposite in sign to the Z of (8); B and C use this one."""
    return -axial(overlaps)


def C(data: ModalData) -> Array:
    """C_k of Eq (24), int r . phi_k dm (n,) [kg m]."""
    return np.einsum("kii->k", data.moments)

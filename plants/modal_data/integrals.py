"""Sums over the mass points of a body with modes: what the equations of motion need of its shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray
AXES = np.array(
    [[[0, 0, 0], [0, 0, 1], [0, -1, 0]], [[0, 0, -1], [0, 0, 0], [1, 0, 0]], [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]]
)


def axial(P: Array) -> Array:
    """int a x b dm (..., 3) from P = int a b^T dm (..., 3, 3)."""
    return np.einsum("cij,...ij->...c", AXES, P)


def integrals(r: Array, dm: Array, phi: Array, g: Array) -> dict[str, Any]:
    """Fields of ModalData from points r (N, 3) [m] of masses dm (N,) [kg], shapes phi (n, N, 3), shortening g_kl
    (n, n, N, 3) [1/m].
    """
    return {
        "mass": float(dm.sum()),
        "first": dm @ r,
        "second": np.einsum("p,pi,pj->ij", dm, r, r),
        "R": np.einsum("p,kpi->ki", dm, phi),
        "moments": np.einsum("p,pi,kpj->kij", dm, r, phi),
        "overlaps": np.einsum("p,kpi,lpj->klij", dm, phi, phi),
        "shortening": np.einsum("p,klpi->kli", dm, g),
        "shortening_moments": np.einsum("p,pi,klpj->klij", dm, r, g),
        "shortening_overlaps": np.einsum("p,jpa,klpb->jklab", dm, phi, g),
        "shortening_squares": np.einsum("klpa,mnpb->klmnab", g * dm[:, None], g, optimize=True),
    }

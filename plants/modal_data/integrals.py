"""Sums over the mass points of a body with modes: what the equations of motion need of its shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_number
from pliant.plants.core.parameters import require_count
from pliant.plants.core.signals import read_only

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


def nodal(
    positions: Any,
    masses: Any,
    shapes: Any,
    frequencies: Any,
    stiffness: Any,
    damping: Any,
    shortening: Any,
    tip: int,
) -> dict[str, Any]:
    """Fields of ModalData from nodes; the arguments are those of `ModalData.from_nodes`, checked here."""
    r = read_only("ModalData.positions", positions, (-1, 3))
    dm = read_only("ModalData.masses", masses, (len(r),))
    phi = read_only("ModalData.shapes", shapes, (-1, len(r), 3))
    n = len(phi)
    if (dm < 0).any():
        raise ValueError(f"ModalData.masses[{int(np.argmin(dm))}] = {dm.min()} must be >= 0 [kg]")
    tip = require_count("ModalData", "tip", tip, -len(r), len(r) - 1)
    g = np.zeros((n, n, len(r), 3)) if shortening is None else read_only("shortening", shortening, (n, n, len(r), 3))
    found = integrals(r, dm, phi, g)
    modal_mass = np.einsum("klii->kl", found["overlaps"])
    if (frequencies is None) == (stiffness is None):
        raise ValueError("ModalData: exactly one of frequencies [rad/s] and stiffness [N/m] must be given")
    if stiffness is None:
        omega = read_only("ModalData.frequencies", frequencies, (n,))
        stiffness = np.diag(omega**2 * np.diag(modal_mass))
    K = read_only("ModalData.stiffness", stiffness, (n, n))
    if np.ndim(real_array("ModalData.damping", damping)) == 0:
        damping = require_number("ModalData.damping", damping, "nonnegative")
        damping = np.diag(2 * damping * np.sqrt(np.diag(K) * np.diag(modal_mass)))
    return {
        **found,
        "stiffness": K,
        "damping": damping,
        "tip": r[tip],
        "tip_shapes": phi[:, tip],
        "outline": r,
        "outline_shapes": phi,
    }

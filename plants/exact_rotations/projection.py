"""The same bend in other shape functions: coordinates whose curvature comes nearest to a given one over the link.

Curvatures are projected, not deflections: what a link stores is its strain energy, and least squares in curvature keep
that nearest. Shapes of both links are those of `shape_functions.Basis`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant.plants.beams.shape_functions import Basis

from .quadrature import Array, points
from .strain_link import curvatures, stretches

POINTS = 48  # of the integral over the link


def projection(simpler: Basis, finer: Basis) -> Array:
    """P (n, m): the coordinates P q of `finer` (n shapes) that bend as q (m,) of `simpler` does; exact where they can.

    Example
    -------
    >>> cubic = beams.basis("polynomial", 2)
    >>> projection(cubic, beams.basis("polynomial", 3)) @ [1.0, 0.0]  # of more polynomials, the same
    """
    if not (simpler.n and finer.n):
        return np.zeros((finer.n, simpler.n))
    if finer.stretch is not None:
        return nearest(lambda xi: _strains(simpler, xi), lambda xi: _strains(finer, xi))
    return nearest(lambda xi: curvatures(simpler, xi), lambda xi: curvatures(finer, xi))


def _strains(basis: Basis, xi: Array) -> Array:
    """Curvatures and axial strains (k, 2, n), where there are none zero."""
    bent, axial = curvatures(basis, xi), stretches(basis, xi)
    return np.stack([bent, np.zeros_like(bent) if axial is None else axial], axis=1)


def nearest(simpler: Callable[[Array], Array], finer: Callable[[Array], Array]) -> Array:
    """P (n, m) by the curvatures themselves: those of m and of n shapes at xi (k,), (k, .., m) and (k, .., n)."""
    at = points(POINTS)
    root = np.sqrt(at.weight)
    own, other = (np.einsum("k,k...->k...", root, a).reshape(-1, a.shape[-1]) for a in (finer(at.xi), simpler(at.xi)))
    return np.asarray(np.linalg.lstsq(own, other, rcond=None)[0])

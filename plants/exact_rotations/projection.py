"""The same bend in other shape functions: coordinates whose curvature comes nearest to a given one over the link.

Curvatures are projected, not deflections: what a link stores is its strain energy, and least squares in curvature keep
that nearest. Shapes of both links are those of `shape_functions.Basis`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant.plants.beams.shape_functions import Basis

from .quadrature import Array, points
from .strain_link import curvatures

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
    return nearest(lambda xi: curvatures(simpler, xi), lambda xi: curvatures(finer, xi))


def nearest(simpler: Callable[[Array], Array], finer: Callable[[Array], Array]) -> Array:
    """P (n, m) by the curvatures themselves: those of m and of n shapes at xi (k,), (k, m) and (k, n)."""
    at = points(POINTS)
    root = np.sqrt(at.weight)[:, None]
    return np.asarray(np.linalg.lstsq(root * finer(at.xi), root * simpler(at.xi), rcond=None)[0])

"""Quadrature along a beam that is known by its tangents: positions are their integrals, inertia that of positions.

With l_b the Lagrange polynomials of the points, the position is r(xi) = L sum_b t_b int_0^xi l_b, and the kinetic
energy about a resting root (1/2) rho A L^3 sum_ab W_ab t_a' . t_b', W_ab = int int l_a(x) l_b(y) (1 - max(x, y)) dx dy.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.polynomial import legendre

from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray
TINY = 1e-14  # of the largest entry: constants below are rounding


@dataclass(frozen=True, eq=False)
class Points(OwnsArrays):
    """Gauss-Legendre points on equal panels of [0, 1], and what integrates a polynomial through them."""

    xi: Array  # (m,)
    weight: Array  # (m,), int_0^1
    root: Array  # (m, m) lower triangular, root^T root = W
    panels: int

    @property
    def first_moment(self) -> Array:
        """int_0^1 int_0^xi l_b = int (1 - xi) l_b, (m,)."""
        return self.weight * (1 - self.xi)

    def cumulative(self, xi: Array) -> Array:
        """int_0^xi l_b for xi (k,) in [0, 1] -> (k, m): positions along the beam from the tangents."""
        xi = np.atleast_1d(np.asarray(xi, dtype=float))
        m = len(self.xi) // self.panels
        panel = np.minimum((xi * self.panels).astype(int), self.panels - 1)
        out = np.where(np.arange(self.panels) < panel[:, None], 1.0, 0.0).repeat(m, axis=1) * self.weight
        local = _antiderivatives(m, xi * self.panels - panel) / self.panels
        for k, j in enumerate(panel):
            out[k, j * m : (j + 1) * m] = local[k]
        return out


def _antiderivatives(m: int, z: Array) -> Array:
    """int_0^z l_b of the m Gauss-Legendre points of [0, 1], (k, m)."""
    x, w = legendre.leggauss(m)
    k = np.arange(m)
    project = (2 * k[:, None] + 1) / 2 * legendre.legvander(x, m - 1).T * w  # values to Legendre coefficients
    integrals = np.array([legendre.legval(2 * z - 1, legendre.legint(row, lbnd=-1)) for row in np.eye(m)])
    return integrals.T / 2 @ project


@lru_cache(maxsize=64)
def points(m: int, panels: int = 1) -> Points:
    """m points on each of `panels` equal parts; W is exact for tangents of degree m - 1 on each."""
    x, w = np.polynomial.legendre.leggauss(m)
    start = np.arange(panels)[:, None]
    found = Points(((start + (1 + x) / 2) / panels).ravel(), np.tile(w / (2 * panels), panels), np.empty(0), panels)
    finer, weight = np.polynomial.legendre.leggauss(m + 1)
    at, weight = ((start + (1 + finer) / 2) / panels).ravel(), np.tile(weight / (2 * panels), panels)
    reach = found.cumulative(at)
    W = reach.T @ (weight[:, None] * reach)
    root = np.linalg.cholesky(W[::-1, ::-1]).T[::-1, ::-1]
    return Points(found.xi, found.weight, root, panels)


def sparse(matrix: Array) -> ca.DM:
    """A constant matrix without what is only rounding."""
    return ca.sparsify(ca.DM(np.where(np.abs(matrix) > TINY * np.abs(matrix).max(initial=0.0), matrix, 0.0)))


def applied(matrix: Array, q: ca.SX) -> ca.SX:
    """A constant matrix (m, n) times coordinates q, of any shape where there are none, (m, 1)."""
    return ca.densify(sparse(matrix) @ ca.reshape(q, matrix.shape[1], 1))

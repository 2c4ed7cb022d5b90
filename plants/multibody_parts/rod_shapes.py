"""Shapes of a rod that stretches or twists, held at its root: dimensionless, int a_k a_l dxi = 1 or 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pliant.plants.beams.euler_bernoulli_modes import quadrature
from pliant.plants.beams.shape_functions import Basis

Array = np.ndarray


@dataclass(frozen=True)
class RodShapes:
    """sqrt(2) sin((k - 1/2) pi xi), the modes of a free end, or orthonormal polynomials that span xi .. xi^n."""

    kind: str  # "clamped-free" or "polynomial"
    n: int

    def __call__(self, xi: float | Array, derivative: int = 0) -> Array:
        """a(xi) or a'(xi), xi (...,) -> (..., n)."""
        xi = np.asarray(xi, dtype=float)
        if self.kind == "clamped-free":
            k = (np.arange(self.n) + 0.5) * np.pi
            angle = xi[..., None] * k
            return np.sqrt(2.0) * (k * np.cos(angle) if derivative else np.sin(angle))
        return _raw(self.n, xi, derivative) @ _mixed(self.n)


def _raw(n: int, xi: Array, derivative: int) -> Array:
    """xi P_k(2 xi - 1) or its slope, P_k Legendre's."""
    x, found = 2 * xi - 1, np.zeros((*xi.shape, n))
    for k in range(n):
        P = np.polynomial.legendre.Legendre.basis(k)
        found[..., k] = P(x) + 2 * xi * P.deriv()(x) if derivative else xi * P(x)
    return found


@lru_cache(maxsize=32)
def _mixed(n: int) -> Array:
    """(n, n): what makes them orthonormal, slope at the root > 0."""
    x, w = np.polynomial.legendre.leggauss(n + 2)
    _, R = np.linalg.qr(np.sqrt(w / 2)[:, None] * _raw(n, (1 + x) / 2, 0))
    mixed = np.linalg.inv(R) if n else np.zeros((0, 0))
    return mixed * np.sign(_raw(n, np.array(0.0), 1) @ mixed)


@dataclass(frozen=True, eq=False)
class RodIntegrals:
    """Over xi: a, xi a, a' a'^T, and a phi^T with the shapes of bending."""

    shapes: RodShapes
    first: Array
    moment: Array
    stiffness: Array
    bending: Array

    @classmethod
    def of(cls, kind: str, n: int, bent: Basis) -> RodIntegrals:
        a = RodShapes(kind, n)
        xi, w = quadrature(max(n, bent.n, 1))
        value, slope, phi = a(xi), a(xi, 1), bent.phi(xi)
        return cls(a, w @ value, (w * xi) @ value, slope.T @ (w[:, None] * slope), value.T @ (w[:, None] * phi))

"""Sums along tangents: mass matrix, inertial forces and weighted positions from tangents at points, however they come.

With P_c = root dt_c/dq and root^T root = W, see `quadrature`, sum_ab W_ab dt_a . dt_b is sum_c P_c^T P_c.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca
import numpy as np

from .quadrature import Array, Points, sparse


class TangentSums(ABC):
    """Of tangents t (d lists of (m,)) at `points`, their rates and what is left of t'' where q'' = 0."""

    points: Points
    d: int
    t: list[ca.SX]
    rate: list[ca.SX]
    bias: list[ca.SX]

    @property
    @abstractmethod
    def P(self) -> list[ca.SX]:
        """root dt_c/dq, d matrices (m, n)."""

    def mass(self) -> ca.SX:
        """sum_ab W_ab dt_a/dq . dt_b/dq, (n, n); times rho A L^3 it is the mass matrix."""
        n = self.P[0].shape[1]
        M = ca.SX(n, n)
        for i in range(n):
            for j in range(i + 1):
                M[i, j] = M[j, i] = sum(ca.dot(p[:, i], p[:, j]) for p in self.P)
        return ca.densify(M)

    def kinetic(self) -> ca.SX:
        """sum_ab W_ab t_a' . t_b' / 2 from the rates themselves."""
        return sum((ca.sumsqr(sparse(self.points.root) @ rate) for rate in self.rate), ca.SX(0)) / 2

    def inertia_force(self) -> ca.SX:
        """sum_ab W_ab dt_a/dq . (t_b'' where q'' = 0), (n,): to be subtracted from the forces."""
        root = sparse(self.points.root)
        return sum((p.T @ (root @ c) for p, c in zip(self.P, self.bias)), ca.SX(0))

    def sum(self, weight: Array) -> ca.SX:
        """sum_b weight_b t_b, (d,)."""
        return ca.vertcat(*[ca.dot(ca.DM(weight), t) for t in self.t])

    def sum_rate(self, weight: Array) -> ca.SX:
        """Its time derivative, (d,)."""
        return ca.vertcat(*[ca.dot(ca.DM(weight), t) for t in self.rate])

    def sum_bias(self, weight: Array) -> ca.SX:
        """Its second time derivative where q'' = 0, (d,)."""
        return ca.vertcat(*[ca.dot(ca.DM(weight), t) for t in self.bias])

    def sum_jacobian(self, weight: Array) -> ca.SX:
        """Its derivative by q, (d, n)."""
        through = ca.DM(np.linalg.solve(self.points.root.T, weight))
        return ca.vertcat(*[through.T @ p for p in self.P])


class DifferentiatedTangents(TangentSums):
    """Tangents (d, m) that are any expression of q (n,): their derivatives come from differentiating them."""

    def __init__(self, points: Points, tangents: ca.SX, q: ca.SX, v: ca.SX) -> None:
        self.points, self.d = points, tangents.shape[0]
        self.t = [tangents[c, :].T for c in range(self.d)]
        self.rate = [ca.jtimes(e, q, v) for e in self.t]
        self.bias = [ca.jtimes(e, q, v) for e in self.rate]
        self._P = [sparse(points.root) @ ca.jacobian(e, q) for e in self.t]

    @property
    def P(self) -> list[ca.SX]:
        """root dt_c/dq, d matrices (m, n)."""
        return self._P

"""The equations of a planar rotation field in the turns of as many of its points as it has coordinates.

With theta = psi q at m points, z = theta at n of them (the nodes) is as good as q, and the other turns follow from
B z: half of all products with psi are then products with one. With G_ab = W_ab cos(theta_a - theta_b), by nodes N and
the others O, the mass matrix is

    psi^T G psi = G_NN + H B + (H B)^T,   H = G_NO + B^T G_OO / 2

in z: at seven shapes and fourteen points two fifths of the operations that it takes in q, and the same to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import OwnsArrays

from .quadrature import Array, Points, sparse


@dataclass(frozen=True, eq=False)
class NodalField(OwnsArrays):
    """t = (cos theta, sin theta), theta = psi q at the points; psi (m, n) of full rank, m >= n."""

    points: Points
    psi: Array

    @cached_property
    def order(self) -> Array:
        """All points, (m,): the nodes first, those whose turns tell the coordinates best, then the others."""
        n = self.psi.shape[1]
        nodes = np.sort(linalg.qr(self.psi.T, mode="r", pivoting=True)[1][:n])
        return np.concatenate([nodes, np.setdiff1d(np.arange(len(self.psi)), nodes)])

    @cached_property
    def to_nodes(self) -> Array:
        """z = to_nodes q, (n, n)."""
        return self.psi[self.order[: self.psi.shape[1]]]

    @cached_property
    def from_nodes(self) -> Array:
        """q = from_nodes z, (n, n)."""
        return np.linalg.inv(self.to_nodes)

    @cached_property
    def others(self) -> Array:
        """B (m - n, n)."""
        return np.asarray(self.psi[self.order[self.psi.shape[1] :]] @ self.from_nodes)

    def at(self, q: ca.SX, v: ca.SX) -> NodalTangents:
        """The tangents at coordinates q and rates v (n,)."""
        return NodalTangents(self, q, v)


class NodalTangents:
    """Sums along tangents, see `TangentSums`, in the turns z of the nodes."""

    def __init__(self, field: NodalField, q: ca.SX, v: ca.SX) -> None:
        self.field, self._n = field, field.psi.shape[1]
        self._psi = psi = sparse(field.psi[field.order])
        angle, self._turn = psi @ q, psi @ v
        self.cos, self.sin = ca.cos(angle), ca.sin(angle)
        root = field.points.root[:, field.order]
        self._W = root.T @ root

    def _gathered(self, rows: ca.SX) -> ca.SX:
        """From all points (m, k), nodes first, to the nodes' turns: (n, k)."""
        return rows[: self._n, :] + sparse(self.field.others).T @ rows[self._n :, :]

    def mass(self) -> ca.SX:
        """sum_ab W_ab dt_a/dz . dt_b/dz, (n, n)."""
        n, m = self._n, len(self._W)
        G, B = ca.SX(m, m), sparse(self.field.others)
        for a in range(m):
            for b in range(a + 1):
                G[a, b] = G[b, a] = self._W[a, b] * (self.cos[a] * self.cos[b] + self.sin[a] * self.sin[b])
        H = (G[:n, n:] + B.T @ (G[n:, n:] / 2)) @ B
        M = ca.SX(n, n)
        for i in range(n):
            for j in range(i + 1):
                M[i, j] = M[j, i] = G[i, j] + (H[i, j] + H[j, i])
        return ca.densify(M)

    def inertia_force(self, a: ca.SX) -> ca.SX:
        """sum_ab W_ab dt_a/dz . t_b'' at accelerations a (n,) of the coordinates, (n,)."""
        W, squared, turned = sparse(self._W), self._turn**2, self._psi @ a
        x, y = W @ (self.cos * squared + self.sin * turned), W @ (self.sin * squared - self.cos * turned)
        return self._gathered(self.sin * x - self.cos * y)

    def sum_jacobian(self, weight: Array) -> ca.SX:
        """The derivative by z of sum_b weight_b t_b, (2, n)."""
        W = ca.DM(weight[self.field.order])
        return ca.horzcat(self._gathered(-W * self.sin), self._gathered(W * self.cos)).T

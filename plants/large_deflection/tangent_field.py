"""A beam whose rotation field is exact: its tangent t is a unit vector by construction, its position the integral of t.

The tangent is known at quadrature points xi_b of the reference length, as a function of a few local angles
a_j(xi_b) = sum_i A_j[b, i] q_i. Everything the equations of motion need then follows from constant matrices,
see `exact_rotations.quadrature`.

Valid    inextensible, unshearable; any rotation in the plane
Source   the geometric variable-strain approach, with rotations expanded in place of curvatures: slopes of shapes for
         the force at the tip (`legendre_ritz.tip_force`), of linear modes, or of polynomials
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from pliant.plants import beams
from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.exact_rotations.projection import nearest
from pliant.plants.exact_rotations.quadrature import Array, Points, sparse
from pliant.plants.exact_rotations.tangent_sums import TangentSums


@dataclass(frozen=True, eq=False)
class TangentField(OwnsArrays):
    """t(a_1, .., a_k), d components, at the points, with constant a_j = A_j q.

    angles, tangent: the symbols a (k,) and the expression of t (d,) in them.
    """

    points: Points
    angles: ca.SX
    tangent: ca.SX
    A: tuple[Array, ...]  # k matrices (m, n)

    def at(self, q: ca.SX, v: ca.SX) -> Tangents:
        """The tangents and their derivatives at coordinates q and rates v (n,)."""
        return Tangents(self, q, v)

    def values(self, q: Array) -> Array:
        """t (m, d) at numeric q."""
        angles = np.column_stack([A @ q for A in self.A])
        return np.asarray(ca.Function("t", [self.angles], [self.tangent]).map(len(angles))(angles.T)).T


class Tangents(TangentSums):
    """A field at q, v: t (d lists of (m,)), and P_c = root dt_c/dq, from which mass matrix and forces follow."""

    def __init__(self, field: TangentField, q: ca.SX, v: ca.SX) -> None:
        a, t = field.angles, field.tangent
        rate = ca.SX.sym("rate", a.shape[0])
        along = ca.jtimes(t, a, rate)
        local = ca.Function("local", [a, rate], [t, ca.jacobian(t, a), along, ca.jtimes(along, a, rate)])
        m, (d, k) = len(field.points.xi), (t.shape[0], a.shape[0])
        angle = ca.horzcat(*[sparse(A) @ q for A in field.A])  # (m, k)
        turn = ca.horzcat(*[sparse(A) @ v for A in field.A])
        found = [local(angle[b, :].T, turn[b, :].T) for b in range(m)]
        self.points, self.d = field.points, d
        self._field = field
        self.t = [ca.vertcat(*[f[0][c] for f in found]) for c in range(d)]
        self.rate = [ca.vertcat(*[f[2][c] for f in found]) for c in range(d)]
        self.bias = [ca.vertcat(*[f[3][c] for f in found]) for c in range(d)]
        self.slope = [[ca.vertcat(*[f[1][c, j] for f in found]) for j in range(k)] for c in range(d)]

    @property
    def P(self) -> list[ca.SX]:
        """root dt_c/dq, d matrices (m, n)."""
        if not hasattr(self, "_P"):
            root, A = self.points.root, self._field.A
            self._P = [
                ca.horzcat(
                    *[sum(sparse(root * Aj[:, i]) @ e for Aj, e in zip(A, slopes)) for i in range(A[0].shape[1])]
                )
                for slopes in self.slope
            ]
        return self._P


@dataclass(frozen=True, eq=False)
class Rotations:
    """Rotation shapes psi_i(xi), i < n, each one at the tip: a coordinate is the tip rotation [rad] it brings.

    Where a heavy payload keeps the tip from turning, the largest rotation on the way is at most ten.
    """

    basis: beams.Basis
    rotating: bool  # whether shape 0 is a rigid rotation about the root, psi = 1

    @property
    def n(self) -> int:
        """How many coordinates."""
        return self.basis.n + self.rotating

    @cached_property
    def scale(self) -> Array:
        """Rotation at the tip that each slope brings, relative to the root, or a tenth of the largest."""
        tip = self.basis.tip_slope - self._root_slope
        along = self.basis.phi(np.linspace(0.0, 1.0, 8 * self.basis.n + 9), 1) - self._root_slope
        least = 0.1 * np.abs(along).max(axis=0)
        return np.where(np.abs(tip) > least, tip, np.copysign(least, tip))

    @property
    def _root_slope(self) -> Array:
        return np.asarray(self.basis.phi(0.0, 1))

    def __call__(self, xi: Array) -> Array:
        """psi at xi (k,) -> (k, n)."""
        bent = (self.basis.phi(xi, 1) - self._root_slope) / self.scale
        return np.column_stack([np.ones_like(xi), bent]) if self.rotating else bent

    def curvature(self, xi: Array) -> Array:
        """dpsi/dxi at xi (k,) -> (k, n)."""
        bent = self.basis.phi(xi, 2) / self.scale
        return np.column_stack([np.zeros_like(xi), bent]) if self.rotating else bent

    def embedding(self, simpler: Rotations) -> Array:
        """The coordinates (n, n of simpler) whose curvature comes nearest; a turn of the root is the same in both."""
        k = int(self.rotating)
        bend = nearest(lambda xi: simpler.curvature(xi)[:, k:], lambda xi: self.curvature(xi)[:, k:])
        return np.asarray(linalg.block_diag(np.eye(k), bend))

    @property
    def stiffness(self) -> Array:
        """int psi' psi'^T dxi, (n, n)."""
        K = self.basis.stiffness / np.outer(self.scale, self.scale)
        return np.pad(K, ((1, 0), (1, 0))) if self.rotating else K

    def inertia(self, at: Points) -> Array:
        """int psi psi^T dxi at these points, (n, n)."""
        psi = self(at.xi)
        S = psi.T @ (at.weight[:, None] * psi)
        return (S + S.T) / 2


def rotations(root: str, kind: str, n: int, **ratios: float) -> Rotations:
    """n bending shapes for a clamped, hinged or driven root: for a tip force, natural modes ("modes") or polynomials.

    `ratios`: those of the payload, see `Payload.ratios`.
    """
    if kind == "modes":
        kind = "pinned-payload" if root == "hinged" else "payload"
    elif kind == "tip-force" and root == "hinged":
        kind = "hinged-tip-force"
    return Rotations(beams.basis(kind, n, stretches=0, **ratios), root != "clamped")


def planar_field(shapes: Rotations, at: Points) -> TangentField:
    """t = (cos theta, sin theta), theta = psi . q, at these points."""
    theta = ca.SX.sym("theta")
    return TangentField(at, theta, ca.vertcat(ca.cos(theta), ca.sin(theta)), (shapes(at.xi),))

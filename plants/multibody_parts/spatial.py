"""Motions, forces and inertia of frames, in their own axes.

A point p fixed in a frame that turns at omega, alpha, with an origin that accelerates by a, does so by a + U p, where
U = alpha~ + omega omega^T - |omega|^2 1. P = int p p^T dm takes the place of the tensor of inertia J = tr(P) 1 - P: it
moves and turns more cheaply.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np

Array = np.ndarray
AROUND = ((1, 2), (2, 0), (0, 1))  # the axes that a turn about x, y, z turns into each other
ENTRIES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


class Motion(NamedTuple):
    """Of a frame, in its own axes."""

    omega: ca.SX
    alpha: ca.SX
    a: ca.SX

    @property
    def U(self) -> ca.SX:
        """(3, 3)."""
        w, b = self.omega, self.alpha
        xx, yy, zz = w[0] ** 2, w[1] ** 2, w[2] ** 2
        xy, xz, yz = w[0] * w[1], w[0] * w[2], w[1] * w[2]
        return ca.blockcat(
            [
                [-yy - zz, xy - b[2], xz + b[1]],
                [xy + b[2], -xx - zz, yz - b[0]],
                [xz - b[1], yz + b[0], -xx - yy],
            ]
        )


class Wrench(NamedTuple):
    """A force and its moment about a frame's origin."""

    f: ca.SX
    n: ca.SX

    def __add__(self, other: Wrench) -> Wrench:  # type: ignore[override]
        return Wrench(self.f + other.f, self.n + other.n)


class Inertia(NamedTuple):
    """m, S and the six upper entries of P."""

    m: ca.SX
    S: ca.SX
    P: ca.SX

    def __add__(self, other: Inertia) -> Inertia:  # type: ignore[override]
        return Inertia(self.m + other.m, self.S + other.S, self.P + other.P)

    @classmethod
    def none(cls) -> Inertia:
        return cls(ca.SX(0), ca.SX.zeros(3), ca.SX.zeros(6))

    def matrix(self) -> ca.SX:
        """P (3, 3)."""
        P = self.P
        return ca.blockcat([[P[0], P[1], P[2]], [P[1], P[3], P[4]], [P[2], P[4], P[5]]])

    def inertial(self, motion: Motion, U: ca.SX) -> Wrench:
        """What moves it so: f = m a + U S, n = S x a + int p x U p dm."""
        V = U @ self.matrix()
        return Wrench(self.m * motion.a + U @ self.S, ca.cross(self.S, motion.a) + axial(V))

    def turning(self, axis: int) -> Wrench:
        """What a unit angular acceleration about an axis through the origin takes."""
        i, j = AROUND[axis]
        P = self.matrix()
        f, n = ca.SX.zeros(3), ca.SX.zeros(3)
        f[i], f[j] = -self.S[j], self.S[i]
        n[axis], n[i], n[j] = P[i, i] + P[j, j], -P[i, axis], -P[j, axis]
        return Wrench(f, n)

    def sliding(self, direction: Array) -> Wrench:
        """What a unit acceleration along a direction takes."""
        e = ca.SX(ca.DM(direction))
        return Wrench(self.m * e, ca.cross(self.S, e))


def axial(V: ca.SX) -> ca.SX:
    """int p x b dm from V = int b p^T dm."""
    return ca.vertcat(V[2, 1] - V[1, 2], V[0, 2] - V[2, 0], V[1, 0] - V[0, 1])


def upper(P: ca.SX) -> ca.SX:
    """The six upper entries."""
    return ca.vertcat(*[P[i, j] for i, j in ENTRIES])

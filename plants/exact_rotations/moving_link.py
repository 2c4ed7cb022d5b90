"""Inertia and inertial forces of a link of exact rotations, written out: a quarter of what differentiating T costs.

The root stands turned by `turn` in the plane, at rest or carried; the coordinates here are y = (turn, q). With
G_b = (1, psi(xi_b)/L) the section at point b stands at the angle Theta_b = G_b . y, its tangent t_b changes by
Theta_b' n_b, and

    T = (1/2) y' . M y',  M = m L^2 sum_ab W_ab cos(Theta_a - Theta_b) G_a G_b^T,
    M y'' + m L^2 sum_ab G_a W_ab sin(Theta_a - Theta_b) Theta_b'^2 = Q.

Where the root is carried, its acceleration acts on the first moment, and so does weight.
Valid    as `strain_link`, without shear
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from pliant.plants.beams.payload import Payload

from .quadrature import Array, applied, sparse
from .strain_link import StrainLink, constant_inertia, turns

PAIRWISE = 7  # coordinates: with more, products of Jacobians take fewer operations than pairs of points


@dataclass(frozen=True)
class Arrived:
    """A sum of positions r: dr/dy (2, 1 + n), and d2r/dt2 where y'' = 0 (2,), in inertial axes."""

    jacobian: ca.SX
    bias: ca.SX

    def __add__(self, other: Arrived) -> Arrived:
        return Arrived(self.jacobian + other.jacobian, self.bias + other.bias)

    def __rmul__(self, factor: ca.SX | float) -> Arrived:
        return Arrived(factor * self.jacobian, factor * self.bias)


@dataclass(frozen=True)
class MovingLink:
    """A link at (turn, q) with rates; M y'' + force = Q with its root at rest and no weight."""

    M: ca.SX  # (1 + n, 1 + n)
    force: ca.SX  # (1 + n,)
    tip: Arrived  # [m]
    moment: Arrived  # int r dm of link and load, from the root [kg m]
    mass: ca.SX | float

    @classmethod
    def of(cls, link: StrainLink, turn: ca.SX, turn_rate: ca.SX, q: ca.SX, v: ca.SX) -> MovingLink:
        """The bare link; `turn` [rad] of its root against the x axis."""
        at, beam = link.points, link.beam
        psi = turns(link.basis, at.xi)
        G = np.column_stack([np.ones(len(at.xi)), psi])  # of (turn, q/L)
        angle = turn + applied(psi, q) / beam.length
        square = (turn_rate + applied(psi, v) / beam.length) ** 2
        c, s = ca.cos(angle), ca.sin(angle)

        def summed(weight: Array) -> Arrived:
            rows = sparse(weight[:, None] * G)
            return Arrived(
                ca.vertcat(-s.T @ rows, c.T @ rows), -ca.vertcat(*[_dot(weight, square * t) for t in (c, s)])
            )

        build = _of_pairs if G.shape[1] <= PAIRWISE else _of_products
        M, force = build(G, at.root, c, s, square)
        size = ca.vertcat(1.0, *[1 / beam.length] * link.basis.n)
        scale = size @ size.T
        L, m = beam.length, beam.mass
        tip, first = summed(at.weight), summed(at.first_moment)
        spread = ca.repmat(size.T, 2, 1)
        return cls(
            M=m * L**2 * (M * scale) + constant_inertia(link),
            force=m * L**2 * (force * size),
            tip=Arrived(L * (tip.jacobian * spread), L * tip.bias),
            moment=Arrived(m * L * (first.jacobian * spread), m * L * first.bias),
            mass=m,
        )

    def carrying(self, mass: ca.SX | float, at: Arrived) -> MovingLink:
        """With a point mass [kg] at a place that the link moves."""
        J = at.jacobian
        return replace(
            self,
            M=self.M + mass * (J.T @ J),
            force=self.force + mass * (J.T @ at.bias),
            moment=self.moment + mass * at,
            mass=self.mass + mass,
        )

    def loaded(self, link: StrainLink, payload: Payload, turned: ca.SX, rate: ca.SX, carried: bool) -> MovingLink:
        """With a payload at its tip, which has turned to `turned` [rad] at `rate`; `carried`: it has an offset."""
        row = ca.horzcat(1.0, ca.DM(link.basis.tip_slope).T / link.beam.length)
        at = self.tip
        if carried:
            c, s, (ox, oy) = ca.cos(turned), ca.sin(turned), payload.offset[:2]
            x, y = c * ox - s * oy, s * ox + c * oy
            at = at + Arrived(ca.vertcat(-y * row, x * row), -(rate**2) * ca.vertcat(x, y))
        loaded = self.carrying(payload.mass, at)
        return replace(loaded, M=loaded.M + payload.inertia_z * (row.T @ row))


def _dot(weight: Array, values: ca.SX) -> ca.SX:
    return ca.dot(ca.DM(weight), values)


def _of_pairs(G: Array, root: Array, c: ca.SX, s: ca.SX, square: ca.SX) -> tuple[ca.SX, ca.SX]:
    """sum_ab W_ab cos(Theta_a - Theta_b) G_a G_b^T and its force, from the cosines and sines of pairs of points."""
    (m, n), W = G.shape, root.T @ root
    a, b = np.triu_indices(m, 1)
    own = G.T @ (np.diag(W)[:, None] * G)
    M, force = ca.SX(n, n), [ca.SX(0)] * m
    if len(a):
        ca_, cb, sa, sb = c[list(a)], c[list(b)], s[list(a)], s[list(b)]
        cosine, sine = ca_ * cb + sa * sb, ca.DM(W[a, b]) * (sa * cb - ca_ * sb)
    for k, (one, other) in enumerate(zip(a.tolist(), b.tolist())):
        force[one] += sine[k] * square[other]
        force[other] -= sine[k] * square[one]
    for i in range(n):
        for j in range(i + 1):
            weight = W[a, b] * (G[a, i] * G[b, j] + G[b, i] * G[a, j])
            M[i, j] = M[j, i] = own[i, j] + (_dot(weight, cosine) if len(a) else 0)
    return ca.densify(M), sparse(G).T @ ca.vertcat(*force)


def _of_products(G: Array, root: Array, c: ca.SX, s: ca.SX, square: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The same from P = root dt/dy of both components of the tangent."""
    M, force = ca.SX(G.shape[1], G.shape[1]), ca.SX(G.shape[1], 1)
    for normal, tangent in ((-s, c), (c, s)):
        P = ca.horzcat(*[sparse(root * G[:, i]) @ normal for i in range(G.shape[1])])
        M += P.T @ P
        force -= P.T @ (sparse(root) @ (square * tangent))
    return ca.densify(M), force

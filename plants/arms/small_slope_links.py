"""Inertia and inertial forces of a link of small slopes, written out in the axes of its root.

The coordinates are (phi, q), phi the angle of the root and q the deflections, with rates (omega, v). The point at x
stands at (x - s, u), u = phi(xi) . q, s = q . S(xi) q/(2 L) or nothing; see `beams.elastic_link`. With the moments
X = int (x - s) dm, Y = int u dm, the turning inertia J = int ((x - s)^2 + u^2) dm = J0 + m q . A q to second order and
its constant coupling c,

    T = (1/2) omega^2 J + omega c . v + (1/2) v . M v,     J' = 2 m (A q) . v,
    the inertial forces where the accelerations vanish: (2 omega m (A q) . v, -omega^2 m A q).

A place r = (x, y) that the link moves has, in the same axes, dr = (-y, x) dphi + (dx/dq, dy/dq) dq and the
acceleration (x'' - 2 omega y' - omega^2 x, y'' + 2 omega x' - omega^2 y), x'' and y'' within the axes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.payload import Payload

Value = ca.SX | float
TINY = 1e-14  # of what is largest in its row and column: entries below are rounding


@dataclass(frozen=True)
class Place:
    """A sum of positions (x, y), in the axes of the root: by q constant across, `along` . dq along, less the bow."""

    x: ca.SX
    y: ca.SX
    along: ca.SX  # dx/dq (n,)
    across: ca.SX  # dy/dq (n,)
    bias: tuple[ca.SX, ca.SX]  # accelerations where omega' = 0, v' = 0

    def work(self, force: tuple[ca.SX, ca.SX]) -> ca.SX:
        """Generalised forces (1 + n,) of a force in the same axes."""
        fx, fy = force
        return ca.vertcat(self.x * fy - self.y * fx, self.along * fx + self.across * fy)

    def __add__(self, other: Place) -> Place:
        bias = self.bias[0] + other.bias[0], self.bias[1] + other.bias[1]
        return Place(self.x + other.x, self.y + other.y, self.along + other.along, self.across + other.across, bias)

    def __rmul__(self, by: Value) -> Place:
        return Place(
            by * self.x, by * self.y, by * self.along, by * self.across, (by * self.bias[0], by * self.bias[1])
        )

    @property
    def jacobian(self) -> ca.SX:
        """(2, 1 + n)."""
        return ca.blockcat([[-self.y, self.along.T], [self.x, self.across.T]])


@dataclass(frozen=True)
class SmallSlopeLink:
    """M (omega'; v') + force = Q with the root at rest and no weight."""

    link: ElasticLink
    omega: ca.SX
    q: ca.SX  # (n,)
    v: ca.SX
    turning: ca.SX  # M[0, 0]
    coupling: ca.SX  # M[0, 1:] (n,)
    M: ca.SX  # (n, n)
    force: ca.SX  # (1 + n,)
    radius: Value  # of the hub that the root stands on [m]

    @classmethod
    def of(cls, link: ElasticLink, omega: ca.SX, q: ca.SX, v: ca.SX, radius: Value = 0.0) -> SmallSlopeLink:
        """The bare link."""
        basis, (L, m), n = link.basis, (link.beam.length, link.beam.mass), link.basis.n
        q, v = ca.reshape(q, n, 1), ca.reshape(v, n, 1)
        A = basis.mass - basis.shortening_moment if link.stiffened else basis.mass
        bent = m * (tidy(A) @ q)
        turning = m * L**2 / 3 + ca.dot(q, bent)
        coupling, M = m * L * column(basis.moment), m * square(basis.mass)
        if basis.rotary is not None and basis.rotary_first is not None:
            per_area = link.beam.I_z / link.beam.area
            turning = turning + m * per_area
            coupling = coupling + m * per_area / L * column(basis.rotary_first)
            M = M + m * per_area / L**2 * square(basis.rotary)
        force = ca.vertcat(2 * omega * ca.dot(bent, v), -(omega**2) * bent)
        return cls(link, omega, q, v, ca.SX(turning), ca.SX(coupling), ca.SX(M), force, radius)._on_hub()

    def _on_hub(self) -> SmallSlopeLink:
        """The root moves on a circle: every point is further out."""
        if not isinstance(self.radius, ca.SX) and self.radius == 0.0:
            return self
        r, m, bare = self.radius, self.link.beam.mass, replace(self, radius=0.0).mass_moment()
        pulled = ca.vertcat(2 * r * self.omega * ca.dot(bare.along, self.v), -r * self.omega**2 * bare.along)
        return replace(
            self,
            turning=self.turning + 2 * r * bare.x + m * r**2,
            coupling=self.coupling + r * bare.across,
            force=self.force + pulled,
        )

    def _place(self, start: Value, across: ca.SX, shortened: ca.SX | ca.DM, by: Value) -> Place:
        """At x = start - by q . S q/2, y = across . q."""
        along = -by * (shortened @ self.q)
        x, y = start + ca.dot(along, self.q) / 2, ca.dot(across, self.q)
        own = -by * ca.dot(self.v, shortened @ self.v)
        w, square_of = self.omega, self.omega**2
        bias = own - 2 * w * ca.dot(across, self.v) - square_of * x, 2 * w * ca.dot(along, self.v) - square_of * y
        return Place(x, y, along, across, bias)

    def _shortening(self, S: np.ndarray) -> ca.DM:
        return tidy(S) if self.link.stiffened else ca.DM(*S.shape)

    def tip(self) -> Place:
        """Where the link ends [m]."""
        basis, L = self.link.basis, self.link.beam.length
        return self._place(L + self.radius, ca.SX(column(basis.tip)), self._shortening(basis.shortening), 1 / L)

    def mass_moment(self, load: Value = 0.0) -> Place:
        """int r dm [kg m], with a mass [kg] at the tip."""
        basis, L, m = self.link.basis, self.link.beam.length, self.link.beam.mass
        start = m * (L / 2 + self.radius) + load * (L + self.radius)
        across = m * column(basis.first) + load * column(basis.tip)
        if isinstance(m, ca.SX) or isinstance(L, ca.SX) or isinstance(load, ca.SX):
            mean, end = self._shortening(basis.shortening_mean), self._shortening(basis.shortening)
            return self._place(start, ca.SX(across), m / L * mean + load / L * end, 1.0)
        whole = m / L * basis.shortening_mean + load / L * basis.shortening
        return self._place(start, ca.SX(across), self._shortening(whole), 1.0)

    def carrying(self, mass: Value, at: Place, *, moving: bool = True) -> SmallSlopeLink:
        """With a point mass [kg] at a place; its force too, unless it is brought in otherwise."""
        weighed = mass * at.along
        return replace(
            self,
            turning=self.turning + mass * (at.x**2 + at.y**2),
            coupling=self.coupling + at.x * (mass * at.across) - at.y * weighed,
            M=(self.M + mass * (at.across @ at.across.T)) + weighed @ at.along.T,
            force=self.force + at.work((mass * at.bias[0], mass * at.bias[1])) if moving else self.force,
        )

    def loaded(self, payload: Payload, carried: bool) -> tuple[SmallSlopeLink, Place]:
        """With a payload, and the mass moment of both; `carried`: the payload's offset is not zero."""
        row, at = ca.SX(column(self.link.basis.tip_slope)) / self.link.beam.length, self.tip()
        if carried:
            turned, rate = ca.dot(row, self.q), self.omega + ca.dot(row, self.v)
            c, s, (ox, oy) = ca.cos(turned), ca.sin(turned), payload.offset[:2]
            x, y = c * ox - s * oy, s * ox + c * oy
            bias = at.bias[0] - rate**2 * x, at.bias[1] - rate**2 * y
            at = Place(at.x + x, at.y + y, at.along - y * row, at.across + x * row, bias)
            own, m = self.mass_moment(), payload.mass
            moment = own + m * at
        else:
            moment = self.mass_moment(payload.mass)
        J, loaded = payload.inertia_z, self.carrying(payload.mass, at)
        return replace(
            loaded,
            turning=loaded.turning + J,
            coupling=loaded.coupling + J * row,
            M=loaded.M + J * (row @ row.T),
        ), moment

    def elastic_force(self) -> ca.SX:
        """Of strain and of losses within (n,), on the coordinates' side of M a."""
        beam, basis = self.link.beam, self.link.basis
        felt = self.q + beam.damping * self.v
        force = beam.EI / beam.length**3 * (tidy(basis.stiffness) @ felt)
        if basis.shear is not None:
            force = force + beam.shear_stiffness / beam.length * (tidy(basis.shear) @ felt)
        return ca.SX(force)

    @property
    def inertia(self) -> ca.SX:
        """(1 + n, 1 + n)."""
        return ca.blockcat([[self.turning, self.coupling.T], [self.coupling, self.M]])


def column(values: np.ndarray) -> ca.DM:
    """Constants (n, 1), where n = 0 too."""
    return ca.DM(np.asarray(values, dtype=float).reshape(-1, 1))


def square(S: np.ndarray) -> ca.DM:
    """A constant matrix, where n = 0 too."""
    return ca.DM(np.asarray(S, dtype=float).reshape(len(S), len(S)))


def tidy(S: np.ndarray) -> ca.DM:
    """A constant symmetric matrix without entries that are rounding of what is largest in their row and column."""
    size = np.sqrt(np.abs(S).max(axis=0, initial=0.0))
    return ca.sparsify(square(np.where(np.abs(S) > TINY * np.outer(size, size), S, 0.0)))

"""A beam whose root moves in space, by its modal integrals: bending in two planes, torsion and stretch.

In the axes of its root the point at x = L xi stands at p = (x + a(xi) . e - s, phi(xi) . y, phi(xi) . z), its section
turns by (tau(xi) . t, -phi'(xi) . z/L, phi'(xi) . y/L); coordinates eta = (y, z, t, e). Stiffened, s is the shortening
(y . S(xi) y + z . S(xi) z)/(2 L), kept to second order in the energies; linear, it is left out. The kinetic energy

    T = m v^2/2 + v . (omega x S + S') + omega . J omega/2 + omega . H + eta' . M eta'/2

has S = int p dm, J = tr(P) 1 - P with P = int p p^T dm, H = int p x p' dm as functions of eta. Lagrange's equations in
quasi-coordinates then give, whatever is left out of these functions, forces that keep the energy:

    f = m a + U S + 2 omega x S' + S''
    n = S x a + int p x U p dm + J' omega + omega x H
    Q = S_eta . a + int p_eta . U p dm + 2 omega . int p_eta' x .. + M eta''.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants import beams
from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.euler_bernoulli_modes import quadrature
from pliant.plants.beams.section import Beam
from pliant.plants.core.casadi_functions import entries

from .rod_shapes import RodIntegrals, RodShapes
from .spatial import Inertia, Wrench

FAMILIES = ("y", "z", "twist", "stretch")
TINY = 1e-14


def tidy(a: np.ndarray) -> ca.DM:
    """With structural zeros in place of rounding."""
    a = np.asarray(a, dtype=float)
    return ca.sparsify(ca.DM(np.where(np.abs(a) > TINY * np.abs(a).max(initial=0.0), a, 0.0)))


def head(v: ca.SX, k: int) -> ca.SX:
    """The first k entries, as a column."""
    return entries(v, slice(0, k))


@dataclass(frozen=True)
class Section:
    """Where a section stands and how it turns: about z, then y, then x, by `turn`."""

    shift: ca.SX  # (3,) [m] from the root
    shift_rate: ca.SX
    shift_bias: ca.SX  # [m/s^2]
    turn: ca.SX  # (3,) [rad]
    turn_rate: ca.SX
    T: ca.SX  # (6, n): shift and turn by the coordinates
    twist_bias: ca.SX | None = None  # [rad/s^2] of the turn about x; the others have none


@dataclass(frozen=True, eq=False)
class TreeBeam:
    """A beam with its shapes; `counts` of each family. The beam may hold symbols, the shapes are numbers."""

    beam: Beam
    counts: tuple[int, ...]
    basis: str
    stiffened: bool

    @property
    def n(self) -> int:
        return sum(self.counts)

    @cached_property
    def bent_bases(self) -> tuple[beams.Basis, beams.Basis]:
        return beams.basis(self.basis, self.counts[0]), beams.basis(self.basis, self.counts[1])

    @cached_property
    def planes(self) -> tuple[ElasticLink, ElasticLink]:
        """The beam as a link that bends in x-y, and as one that bends in x-z."""
        other = replace(self.beam, I_y=self.beam.I_z, I_z=self.beam.I_y)
        first, second = self.bent_bases
        return ElasticLink(self.beam, first, self.stiffened), ElasticLink(other, second, self.stiffened)

    @cached_property
    def stretch(self) -> tuple[RodIntegrals, RodIntegrals]:
        """The stretch's integrals with bending in both planes."""
        first, second = (RodIntegrals.of(self.basis, self.counts[3], bent) for bent in self.bent_bases)
        return first, second

    @cached_property
    def twist(self) -> RodIntegrals:
        return RodIntegrals.of(self.basis, self.counts[2], self.bent_bases[0])

    def parted(self, eta: ca.SX) -> list[ca.SX]:
        """(y, z, t, e)."""
        ends = np.cumsum((0, *self.counts))
        return [entries(eta, slice(int(a), int(b))) for a, b in pairwise(ends)]

    @property
    def polar(self) -> ca.SX:
        """rho (I_y + I_z) L [kg m^2]."""
        return ca.SX(self.beam.density * self.beam.polar_moment * self.beam.length)

    def shortened(self, S: list[np.ndarray]) -> ca.DM:
        """Of (y, z), block by block; nothing where it is left out."""
        n = self.counts[0] + self.counts[1]
        return ca.diagcat(*[tidy(one) for one in S]) if self.stiffened else ca.DM(n, n)

    def moments(self, eta: ca.SX) -> tuple[ca.SX, ca.SX]:
        """int x phi dm of the shapes of both planes: m (L mo + C^T e), columns."""
        m, L = self.beam.mass, self.beam.length
        e = self.parted(eta)[3]
        found = [
            m * (L * ca.DM(bent.moment) + tidy(rod.bending).T @ e)
            for bent, rod in zip(self.bent_bases, self.stretch, strict=True)
        ]
        return found[0], found[1]

    def inertia(self, eta: ca.SX) -> Inertia:
        """m, S, P; the sections' polar inertia within P, as J = tr(P) 1 - P has it about x alone."""
        m, L = self.beam.mass, self.beam.length
        y, z, _, e = self.parted(eta)
        bent = ca.vertcat(y, z)
        (by, bz), (rod, _) = self.bent_bases, self.stretch
        mean, second = (self.shortened([getattr(b, k) for b in self.bent_bases]) for k in SHORTENINGS)
        S = ca.vertcat(
            m * L / 2 + m * ca.dot(ca.DM(rod.first), e) - m / (2 * L) * ca.dot(bent, mean @ bent),
            m * ca.dot(ca.DM(by.first), y),
            m * ca.dot(ca.DM(bz.first), z),
        )
        my, mz = self.moments(eta)
        xx = m * (L**2 / 3 + 2 * L * ca.dot(ca.DM(rod.moment), e) + ca.dot(e, e) - ca.dot(bent, second @ bent))
        k = min(self.counts[:2])
        half = self.polar / 2
        P = (xx - half, ca.dot(my, y), ca.dot(mz, z), m * ca.dot(y, y) + half, m * ca.dot(head(y, k), head(z, k)))
        return Inertia(ca.SX(m), S, ca.vertcat(*P, m * ca.dot(z, z) + half))

    def coupling(self, eta: ca.SX) -> list[Wrench]:
        """Forces that unit accelerations of the coordinates take at the root: (dS/deta_k, int p x p_k dm)."""
        m, L, zero = self.beam.mass, self.beam.length, ca.SX(0)
        y, z, _, _ = self.parted(eta)
        (by, bz), (ry, rz), bent = self.bent_bases, self.stretch, ca.vertcat(y, z)
        pull = -m / L * (self.shortened([b.shortening_mean for b in self.bent_bases]) @ bent)
        my, mz = self.moments(eta)
        ny, nz, nt, na = self.counts
        found = []
        for k in range(ny):
            across = -m * z[k] if k < nz else zero
            found.append(Wrench(ca.vertcat(pull[k], m * by.first[k], 0), ca.vertcat(across, 0, my[k])))
        for k in range(nz):
            across = m * y[k] if k < ny else zero
            found.append(Wrench(ca.vertcat(pull[ny + k], 0, m * bz.first[k]), ca.vertcat(across, -mz[k], 0)))
        for k in range(nt):
            found.append(Wrench(ca.SX.zeros(3), ca.vertcat(self.polar * self.twist.first[k], 0, 0)))
        for k in range(na):
            turn = ca.vertcat(0, m * (tidy(rz.bending[k : k + 1]) @ z), -m * (tidy(ry.bending[k : k + 1]) @ y))
            found.append(Wrench(ca.vertcat(m * ry.first[k], 0, 0), turn))
        return found

    def mass(self) -> ca.SX:
        """M (n, n): all shapes are orthonormal."""
        ny, nz, nt, na = self.counts
        m = ca.SX(self.beam.mass)
        return ca.diag(ca.vertcat(*[m] * (ny + nz), *[self.polar] * nt, *[m] * na)) if self.n else ca.SX(0, 0)

    def stiffness(self) -> ca.SX:
        """K (n, n); the damping matrix is `beam.damping` times it."""
        b, L = self.beam, self.beam.length
        (by, bz), rods, twist = self.bent_bases, self.stretch[0], self.twist
        blocks = [
            b.EI / L**3 * tidy(by.stiffness),
            b.E * b.I_y / L**3 * tidy(bz.stiffness),
            b.GJ / L * tidy(twist.stiffness),
            b.E * b.area / L * tidy(rods.stiffness),
        ]
        return ca.SX(ca.diagcat(*[ca.SX(block) for block in blocks]))

    def deflection(self, eta: ca.SX) -> list[ca.SX]:
        """Of the end across the beam [m], along its y and its z; of rates their rates."""
        return [ca.dot(ca.DM(b.tip), q) for b, q in zip(self.bent_bases, self.parted(eta)[:2], strict=True)]

    def curvature(self, eta: ca.SX) -> list[ca.SX]:
        """At the root [1/m], in x-y and in x-z."""
        ends = [ca.DM(np.reshape(b.phi(0.0, 2), -1)) for b in self.bent_bases]
        return [ca.dot(k, q) / self.beam.length**2 for k, q in zip(ends, self.parted(eta)[:2], strict=True)]

    def section(self, xi: float, eta: ca.SX, rate: ca.SX) -> Section:
        """The section at x = L xi."""
        L, (y, z, _, _), (v, r, _, _) = self.beam.length, self.parted(eta), self.parted(rate)
        rows = [ca.SX(1, n) for n in self.counts]
        value, slope = ([b.phi(xi, d) for b in self.bent_bases] for d in (0, 1))
        twist, stretch = RodShapes(self.basis, self.counts[2])(xi), self.stretch[0].shapes(xi)
        S = self.shortened([self._up_to(b, xi) for b in self.bent_bases])
        bent, bent_rate = ca.vertcat(y, z), ca.vertcat(v, r)
        pull = -(S @ bent).T / L

        def row(*parts: tuple[int, Any]) -> ca.SX:
            filled = list(rows)
            for family, part in parts:
                filled[family] = ca.SX(ca.DM(np.reshape(part, (1, -1)))) if isinstance(part, np.ndarray) else part
            return ca.SX(ca.horzcat(*filled))

        ny = self.counts[0]
        T = ca.vertcat(
            row((0, pull[:, :ny]), (1, pull[:, ny:]), (3, stretch)),
            row((0, value[0])),
            row((1, value[1])),
            row((2, twist)),
            row((1, -slope[1])) / L,
            row((0, slope[0])) / L,
        )
        at, rates = T @ eta, T @ rate
        bow = ca.dot(bent, S @ bent) / (2 * L)  # T eta counts the shortening twice
        shift = ca.vertcat(L * xi + at[0] + bow, at[1], at[2])
        bias = ca.vertcat(-ca.dot(bent_rate, S @ bent_rate) / L, 0, 0)
        return Section(shift, rates[:3], bias, at[3:], rates[3:], T)

    @staticmethod
    def _up_to(bent: beams.Basis, xi: float) -> np.ndarray:
        """int phi' phi'^T from 0 to xi."""
        if xi == 1.0:
            return bent.shortening
        at, w = quadrature(max(bent.n, 1))
        slope = bent.phi(xi * at, 1)
        return xi * slope.T @ (w[:, None] * slope)


SHORTENINGS = ("shortening_mean", "shortening_moment")

"""A beam in space whose sections turn as far as they like, its root moving as it likes.

In the axes of its root the section at x = L xi has turned by R = R_z(a) R_y(b) R_x(c), with

    a = phi'(xi) . y/L,   b = -phi'(xi) . z/L,   c' = tau' + a' sin b,   t = (1 + e') R e_x,   p = int t dx,

tau and e the twist's and the stretch's shapes: to first order in eta = (y, z, t, e) this is `tree_beam`, to second
order the stiffened one, in a plane `strain_link`. The curvatures are then exactly (tau', b' cos c + a' cos b sin c,
-b' sin c + a' cos b cos c): with c' as it is, a beam that does not twist needs no coordinate for it. Positions are
integrals of tangents; with root^T root = W of `quadrature`, z = root t are points that each carry the whole mass,
P = m L^2 z^T z.

Valid    |b| below 80 degrees, where the angles are singular; Hooke's law, sections without shear; their turning inertia
         and the viscosity of the strain as of the straight beam
Source   J. C. Simo and L. Vu-Quoc, "On the dynamics of flexible beams under large overall motions - the plane case",
         J. Appl. Mech. 53 (1986); in space the geometric variable-strain approach, with angles expanded
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import last_call
from pliant.plants.core.quaternions import cross
from pliant.plants.exact_rotations.quadrature import Points, applied, points, sparse
from pliant.plants.exact_rotations.strain_link import StrainLink, constant_inertia, curvatures, enough, turns
from pliant.plants.multibody_parts.rod_shapes import RodShapes
from pliant.plants.multibody_parts.spatial import Inertia, Motion, Wrench, axial, upper
from pliant.plants.multibody_parts.tree_beam import Section

from .beam_body import BeamBody
from .elastic_body import Place

STRETCHED = 2  # points more than shapes of twist and stretch


class _Placed(NamedTuple):
    """At the points: components (m,) of t = dx/ds and their derivatives J (m, n), those of dx/ds without stretch and
    its derivatives by a, by b and by both, and how long it is.
    """

    t: list[ca.SX]
    J: list[ca.SX]
    unit: list[ca.SX]
    by_a: list[ca.SX]
    by_b: list[ca.SX]
    across: list[ca.SX]  # d2/da2 is -unit but for z, d2/db2 is -unit
    size: ca.SX


class _Tangents(NamedTuple):
    """Those, and components (m,) of the rate of dx/ds and of what is left of its second where eta'' = 0."""

    t: list[ca.SX]
    J: list[ca.SX]  # (m, n) each
    rate: list[ca.SX]
    bias: list[ca.SX]


@dataclass(frozen=True, eq=False)
class StrainBeam(BeamBody):
    """Exact rotations of its sections."""

    @cached_property
    def points(self) -> Points:
        """Enough for bending in each plane, for twist and for stretch."""
        least = points(max(self.straight.counts[2:]) + STRETCHED)
        return max([least, *map(enough, self.straight.bent_bases)], key=lambda at: len(at.xi))

    @cached_property
    def _bends(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """a, a', b, b' at the points by y and z, times L and L^2, (m, n) each."""
        (by, bz), xi = self.straight.bent_bases, self.points.xi
        return turns(by, xi), curvatures(by, xi), -turns(bz, xi), -curvatures(bz, xi)

    @cached_property
    def _stretches(self) -> np.ndarray:
        return RodShapes(self.straight.basis, self.straight.counts[3])(self.points.xi, 1)

    def _angles(self, eta: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """a, b and the stretch at the points, or their rates."""
        y, z, _, e = self.straight.parted(eta)
        L, (a, _, b, _) = self.straight.beam.length, self._bends
        return applied(a, y) / L, applied(b, z) / L, applied(self._stretches, e) / L

    @last_call
    def _placed(self, eta: ca.SX) -> _Placed:
        L, counts, (a, b, e) = self.straight.beam.length, self.straight.counts, self._angles(eta)
        ca_, sa, cb, sb = ca.cos(a), ca.sin(a), ca.cos(b), ca.sin(b)
        size, still = 1 + e, ca.SX.zeros(len(self.points.xi))
        unit, by_a, by_b = [ca_ * cb, sa * cb, -sb], [-sa * cb, ca_ * cb, still], [-ca_ * sb, -sa * sb, -cb]
        J = []
        for c in range(3):
            columns = [_each(size * by_a[c], self._bends[0]), _each(size * by_b[c], self._bends[2])]
            columns += [ca.SX(len(self.points.xi), counts[2]), _each(unit[c], self._stretches)]
            J.append(ca.sparsify(ca.horzcat(*columns) / L))
        return _Placed([size * r for r in unit], J, unit, by_a, by_b, [sa * sb, -ca_ * sb, still], size)

    @last_call
    def _tangents(self, eta: ca.SX, rate: ca.SX) -> _Tangents:
        at, (v, w, d) = self._placed(eta), self._angles(rate)
        found = _Tangents(at.t, at.J, [], [])
        for c in range(3):
            moved = at.by_a[c] * v + at.by_b[c] * w
            found.rate.append(at.size * moved + at.unit[c] * d)
            turned = -at.unit[c] * (w**2 + (v**2 if c < 2 else 0)) + 2 * at.across[c] * v * w
            found.bias.append(at.size * turned + 2 * d * moved)
        return found

    @cached_property
    def _rest(self) -> tuple[ca.SX, ca.SX]:
        """What is constant in the inertia of both planes for (turn, coordinates): see `constant_inertia`."""
        first, second = (StrainLink(p.beam, p.basis, True) for p in self.straight.planes)
        return constant_inertia(first, self.points), constant_inertia(second, self.points)

    def _still(self) -> tuple[ca.SX, list[ca.SX]]:
        """(P (3, 3), moments about the root of unit rates of the coordinates) that stay constant."""
        first, second = self._rest
        own, _, twist = self.straight.polar, self.straight.beam, self.straight.twist
        J = (own, second[0, 0], first[0, 0])
        P = ca.diag(ca.vertcat(J[1] + J[2] - J[0], J[0] + J[2] - J[1], J[0] + J[1] - J[2])) / 2
        ny, nz, nt, ne = self.straight.counts
        turning = [ca.vertcat(0, 0, first[0, 1 + k]) for k in range(ny)]
        turning += [ca.vertcat(0, -second[0, 1 + k], 0) for k in range(nz)]
        turning += [ca.vertcat(own * twist.first[k], 0, 0) for k in range(nt)]
        return P, turning + [ca.SX.zeros(3)] * ne

    def _carried(self, values: list[ca.SX]) -> ca.SX:
        """root v, (m, 3) or (m, n) by components."""
        return ca.horzcat(*[sparse(self.points.root) @ v for v in values])

    def _summed(self, weight: np.ndarray, values: list[ca.SX]) -> ca.SX:
        """L sum_b weight_b v_b, (3, ...)."""
        row = self.straight.beam.length * ca.DM(weight).T
        return ca.vertcat(*[row @ v for v in values])

    @property
    def _size(self) -> ca.SX:
        return ca.SX(self.straight.beam.mass * self.straight.beam.length**2)

    def inertia(self, eta: ca.SX) -> Inertia:
        t = self._placed(eta).t
        z, m = self._carried(t), self.straight.beam.mass
        P = self._size * (z.T @ z) + self._still()[0]
        return Inertia(ca.SX(m), m * self._summed(self.points.first_moment, t), upper(ca.densify(P)))

    def coupling(self, eta: ca.SX) -> list[Wrench]:
        at = self._placed(eta)
        z, J, turning = self._carried(at.t), [sparse(self.points.root) @ j for j in at.J], self._still()[1]
        moved = self.straight.beam.mass * self._summed(self.points.first_moment, at.J)
        found = []
        for k in range(self.n):
            each = ca.horzcat(*[j[:, k] for j in J])
            V = each.T @ z  # sum of J_k z^T
            n = axial(V)
            found.append(Wrench(moved[:, k], self._size * n + turning[k]))
        return found

    def mass(self, eta: ca.SX) -> ca.SX:
        J = [sparse(self.points.root) @ j for j in self._placed(eta).J]
        M = self._size * sum((j.T @ j for j in J), ca.SX(self.n, self.n))
        first, second = self._rest
        _, _, nt, ne = self.straight.counts
        twisting = self.straight.polar * ca.SX.eye(nt)
        return ca.SX(M) + ca.diagcat(first[1:, 1:], second[1:, 1:], twisting, ca.SX(ne, ne))

    def inertial(self, motion: Motion, U: ca.SX, eta: ca.SX, rate: ca.SX) -> tuple[Wrench, ca.SX]:
        at, m, w = self._tangents(eta, rate), self.straight.beam.mass, motion.omega
        first, (still, turning) = self.points.first_moment, self._still()
        S, S_rate, S_bias, S_J = (m * self._summed(first, v) for v in (at.t, at.rate, at.bias, at.J))
        z, moving, left = (self._carried(v) for v in (at.t, at.rate, at.bias))
        each = z @ U.T + 2 * (moving @ cross(w).T) + left  # acceleration of each point, (m, 3)
        V = self._size * (each.T @ z) + U @ still
        momentum = sum((rate[k] * h for k, h in enumerate(turning)), ca.SX.zeros(3))
        n = axial(V)
        f = m * motion.a + U @ S + 2 * ca.cross(w, S_rate) + S_bias
        Q = S_J.T @ motion.a + ca.vertcat(*[ca.dot(h, motion.alpha) for h in turning])
        for c, j in enumerate(at.J):
            Q += self._size * ((sparse(self.points.root) @ j).T @ each[:, c])
        return Wrench(f, ca.cross(S, motion.a) + n + ca.cross(w, momentum)), ca.densify(Q)

    def section(self, place: Place, eta: ca.SX, rate: ca.SX) -> Section:
        xi, straight, at = float(place), self.straight, self._tangents(eta, rate)
        L, reach = straight.beam.length, self.points.cumulative(np.array([xi]))[0]
        rows = [ca.SX(1, n) for n in straight.counts]
        (by, bz), where = straight.bent_bases, np.array([xi])
        a, b = ca.SX(ca.DM(turns(by, where))) / L, -ca.SX(ca.DM(turns(bz, where))) / L
        c, c_row, c_bias = self._twist(reach, xi, eta, rate)
        T = ca.vertcat(
            self._summed(reach, at.J), c_row, ca.horzcat(rows[0], b, *rows[2:]), ca.horzcat(a, *rows[1:])
        )  # fmt: skip
        T = ca.sparsify(T)
        turn, turning = T[3:, :] @ eta, T[3:, :] @ rate
        shift, moving, left = (self._summed(reach, v) for v in (at.t, at.rate, at.bias))
        return Section(shift, moving, left, ca.vertcat(c, turn[1:]), turning, T, c_bias)

    def _twist(self, reach: np.ndarray, xi: float, eta: ca.SX, rate: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """c = tau + int a' sin b, its derivative by eta (1, n) and what is left of c'' where eta'' = 0."""
        straight, L = self.straight, self.straight.beam.length
        y, z, twist, _ = straight.parted(eta)
        v, w, _, _ = straight.parted(rate)
        shapes = RodShapes(straight.basis, straight.counts[2])(xi).reshape(1, -1)
        own, none = ca.DM(shapes), ca.SX(1, straight.counts[3])
        if not (straight.counts[0] and straight.counts[1]):
            empty = [ca.SX(1, n) for n in straight.counts[:2]]
            return ca.dot(own.T, twist), ca.horzcat(*empty, own, none), ca.SX(0)
        _, bent, by_b, _ = self._bends
        a, a_rate = applied(bent, y) / L**2, applied(bent, v) / L**2
        b, b_rate = applied(by_b, z) / L, applied(by_b, w) / L
        row = L * ca.DM(reach).T
        by_y, by_z = ca.sin(b).T @ ca.diag(row) @ bent / L**2, (a * ca.cos(b)).T @ ca.diag(row) @ by_b / L
        left = row @ (2 * a_rate * ca.cos(b) * b_rate - a * ca.sin(b) * b_rate**2)
        return ca.dot(own.T, twist) + row @ (a * ca.sin(b)), ca.horzcat(by_y, by_z, own, none), left

    def _more(self, eta: ca.SX) -> ca.SX:
        """What exact curvatures add to the strain energy of the straight beam's matrix [J]."""
        ny, nz, nt, _ = self.straight.counts
        if (ny > 0) + (nz > 0) + (nt > 0) < 2:
            return ca.SX(0)
        beam, at, L = self.straight.beam, self.points, self.straight.beam.length
        y, z, twist, _ = self.straight.parted(eta)
        _, a_bends, b_turns, b_bends = self._bends
        a, b, slope = applied(a_bends, y) / L**2, applied(b_turns, z) / L, applied(b_bends, z) / L**2
        shapes = RodShapes(self.straight.basis, nt)(at.xi)
        c = applied(shapes, twist) + L * ca.DM(at.cumulative(at.xi)) @ (a * ca.sin(b))
        first, across = slope * ca.cos(c) + a * ca.cos(b) * ca.sin(c), a * ca.cos(b) * ca.cos(c) - slope * ca.sin(c)
        density = beam.E * beam.I_y * (first**2 - slope**2) + beam.EI * (across**2 - a**2)
        return L * ca.dot(ca.DM(at.weight), density) / 2

    def resistance(self, eta: ca.SX, rate: ca.SX) -> ca.SX:
        symbol = ca.SX.sym("eta", self.n)
        more = ca.gradient(self._more(symbol), symbol) if self.n else ca.SX(0, 1)
        own = self.straight.stiffness() @ (eta + self.straight.beam.damping * rate)
        return own + ca.substitute(more, symbol, eta)

    def strain_energy(self, eta: ca.SX) -> ca.SX:
        return ca.dot(eta, self.straight.stiffness() @ eta) / 2 + self._more(eta)

    def readings(self, eta: ca.SX, rate: ca.SX) -> list[ca.SX]:
        end = self.section(1.0, eta, rate)
        return [end.shift[1], end.shift[2], end.shift_rate[1], end.shift_rate[2], *self.straight.curvature(eta)]


def _each(v: ca.SX, shapes: np.ndarray) -> ca.SX:
    """v (m,) times each column of shapes (m, n)."""
    return ca.repmat(v, 1, shapes.shape[1]) * ca.DM(shapes)

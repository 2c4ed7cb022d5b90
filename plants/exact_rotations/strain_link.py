"""Energies of an elastic beam whose sections turn as far as they like, its root moving in the plane.

The section at x = L xi has turned against the root by theta = psi(xi) . q/L, psi the slopes of the shape functions:
exact rotations, with curvatures expanded. The tangent is t = (cos theta, sin theta), with shear t + gamma n,
n = (-sin theta, cos theta), with extension (1 + epsilon) t + gamma n. Positions are its integrals: the tip stands at
L int t. In the frame of the root, which
moves at V and turns at omega, the tangent changes by e = (theta' + omega) n, so that

    T = m |V|^2/2 + m L V . int (1 - xi) e + (m L^2/2) sum_ab W_ab e_a . e_b.

To first order in q this is `ElasticLink`, of the same coordinates q [m], to second order the stiffened one, but for
rotary inertia: strain energy and damping are the same constant matrices, and the straight link's inertia is taken from
its integrals, so that quadrature errs only by what the bend adds.

Valid    planar, Hooke's law; sections keep their rotary inertia; without shear and extension unless the basis has them
Source   J. C. Simo and L. Vu-Quoc, "On the dynamics of flexible beams under large overall motions - the plane case",
         J. Appl. Mech. 53 (1986); the geometric variable-strain approach, rotations expanded
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.legendre_ritz import StrainShapes
from pliant.plants.beams.section import Beam
from pliant.plants.beams.shape_functions import Basis

from .quadrature import Array, Points, applied, points, sparse

BENT = 1.0  # [rad]: the largest turn at which quadrature is judged
WITHIN = 1e-3  # of the inertia of any combination of rates: half of it is that of a frequency
FINEST = 64  # points of the rule that others are judged by


def turns(basis: Basis, xi: Array) -> Array:
    """psi (k, n): L times the turn of the section at xi (k,) by each coordinate."""
    phi = basis.phi
    return np.asarray(phi.rotation(xi) if isinstance(phi, StrainShapes) else phi(xi, 1))


def shears(basis: Basis, xi: Array) -> Array | None:
    """L times the shear strain at xi (k,) by each coordinate, (k, n); None without."""
    phi = basis.phi
    return phi.shear_strain(xi) if isinstance(phi, StrainShapes) else None


def stretches(basis: Basis, xi: Array) -> Array | None:
    """L times the axial strain at xi (k,) by each coordinate, (k, n); None without."""
    phi = basis.phi
    return phi.axial_strain(xi) if isinstance(phi, StrainShapes) else None


def curvatures(basis: Basis, xi: Array) -> Array:
    """psi' (k, n): L^2 times the curvature at xi (k,) by each coordinate."""
    phi = basis.phi
    return np.asarray(phi.rotation(xi, 1) if isinstance(phi, StrainShapes) else phi(xi, 2))


def _inertia(basis: Basis, at: Points, q: Array) -> Array:
    """int r' . r' of unit rates (omega, v) (1 + n, 1 + n) by these points, bent by q, length 1."""
    psi, gamma = turns(basis, at.xi), shears(basis, at.xi)
    angle, each = psi @ q, np.column_stack([np.ones(len(at.xi)), psi])
    along, across, still = np.zeros_like(each), each, np.zeros(len(at.xi))
    if gamma is not None:
        along, across = -each * (gamma @ q)[:, None], each + np.column_stack([still, gamma])
    if (axial := stretches(basis, at.xi)) is not None:
        along, across = along + np.column_stack([still, axial]), across + each * (axial @ q)[:, None]
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    rows = np.vstack([at.root @ (c * along - s * across), at.root @ (s * along + c * across)])
    return rows.T @ rows


@lru_cache(maxsize=128)
def enough(basis: Basis) -> Points:
    """The fewest points by which the inertia of the link, bent by its first shape until a section has turned by BENT,
    errs by at most WITHIN of itself, whatever its rates; a straight link's inertia is exact.
    """
    if not basis.n:
        return points(1)
    straight = np.zeros(basis.n)
    bent = straight.copy()
    bent[0] = BENT / np.abs(turns(basis, np.linspace(0.0, 1.0, 101))[:, 0]).max()
    finest = points(FINEST)
    exact, rest = _inertia(basis, finest, bent), _inertia(basis, finest, straight)
    unit = np.linalg.cholesky(exact)
    for m in range(basis.n + 2, FINEST):
        gap = _inertia(basis, points(m), bent) - _inertia(basis, points(m), straight) + rest - exact
        error = np.linalg.solve(unit, np.linalg.solve(unit, gap).T)
        if np.abs(np.linalg.eigvalsh(error)).max() <= WITHIN:
            return points(m)
    return finest


@dataclass(frozen=True)
class StrainLink(ElasticLink):
    """A beam of exact rotations with the interface of `ElasticLink`: what is linear there in q is a tangent's here."""

    @property
    def points(self) -> Points:
        """Where the tangents are known."""
        return enough(self.basis)

    def _angle(self, q: ca.SX) -> ca.SX:
        """theta (m,) at the points, or its rate."""
        return applied(turns(self.basis, self.points.xi), q) / self.beam.length

    def _shear(self, q: ca.SX) -> ca.SX | None:
        """Shear strain (m,) at the points, or its rate; None without."""
        gamma = shears(self.basis, self.points.xi)
        return None if gamma is None else applied(gamma, q) / self.beam.length

    def _stretch(self, q: ca.SX) -> ca.SX | None:
        """Axial strain (m,) at the points, or its rate; None without."""
        axial = stretches(self.basis, self.points.xi)
        return None if axial is None else applied(axial, q) / self.beam.length

    def tangents(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """dr/dx at the points, (m,) each, in the root frame."""
        angle, gamma, axial = self._angle(q), self._shear(q), self._stretch(q)
        c, s = ca.cos(angle), ca.sin(angle)
        x, y = (c, s) if axial is None else ((1 + axial) * c, (1 + axial) * s)
        return (x, y) if gamma is None else (x - gamma * s, y + gamma * c)

    def tangent_rates(self, omega: ca.SX, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
        """d/dt of them, (m,) each, as seen from where the root's frame turns at omega."""
        x, y = self.tangents(q)
        turning = self._angle(v) + omega
        ex, ey = -turning * y, turning * x
        if (sheared := self._shear(v)) is not None:
            angle = self._angle(q)
            ex, ey = ex - sheared * ca.sin(angle), ey + sheared * ca.cos(angle)
        if (stretched := self._stretch(v)) is not None:
            angle = self._angle(q)
            ex, ey = ex + stretched * ca.cos(angle), ey + stretched * ca.sin(angle)
        return ex, ey

    def _sum(self, weight: Array, values: ca.SX) -> ca.SX:
        return ca.dot(ca.DM(weight), values)

    def tip(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        x, y = self.tangents(q)
        weight = self.points.weight
        return self.beam.length * self._sum(weight, x), self.beam.length * self._sum(weight, y)

    def deflection(self, q: ca.SX) -> ca.SX:
        return self.tip(q)[1]

    def deflection_rate(self, q: ca.SX, v: ca.SX) -> ca.SX:
        return self.tip_velocity((ca.SX(0), ca.SX(0)), ca.SX(0), q, v)[1]

    def shortening(self, q: ca.SX) -> ca.SX:
        return self.beam.length - self.tip(q)[0]

    def shortening_rate(self, q: ca.SX, v: ca.SX) -> ca.SX:
        return -self.tip_velocity((ca.SX(0), ca.SX(0)), ca.SX(0), q, v)[0]

    def tip_velocity(self, root: tuple[ca.SX, ca.SX], omega: ca.SX, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
        ex, ey = self.tangent_rates(omega, q, v)
        L, weight = self.beam.length, self.points.weight
        return root[0] + L * self._sum(weight, ex), root[1] + L * self._sum(weight, ey)

    def centre(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        L, m = self.beam.length, self.beam.mass
        x, y = self.tangents(q)
        weight = self.points.first_moment
        return m * L * self._sum(weight, x), m * L * self._sum(weight, y)

    def kinetic_energy(self, root: tuple[ca.SX, ca.SX], omega: ca.SX, q: ca.SX, v: ca.SX) -> ca.SX:
        L, m, at = self.beam.length, self.beam.mass, self.points
        ex, ey = self.tangent_rates(omega, q, v)
        reach, rates = sparse(at.root), ca.vertcat(omega, ca.reshape(v, self.basis.n, 1))
        first = self._sum(at.first_moment, ex), self._sum(at.first_moment, ey)
        return (
            m * (root[0] ** 2 + root[1] ** 2) / 2
            + m * L * (root[0] * first[0] + root[1] * first[1])
            + m * L**2 / 2 * (ca.sumsqr(reach @ ex) + ca.sumsqr(reach @ ey))
            + ca.bilin(constant_inertia(self), rates, rates) / 2
        )

    def centreline(self, q: Array, points: int) -> Array:
        """Points (points, 2) [m] from root to tip in the root frame, for numeric q (n,)."""
        L, at = self.beam.length, self.points
        angle = turns(self.basis, at.xi) @ q / L
        x, y = np.cos(angle), np.sin(angle)
        if (gamma := shears(self.basis, at.xi)) is not None:
            strain = gamma @ q / L
            x, y = x - strain * np.sin(angle), y + strain * np.cos(angle)
        if (axial := stretches(self.basis, at.xi)) is not None:
            strain = axial @ q / L
            x, y = x + strain * np.cos(angle), y + strain * np.sin(angle)
        return L * at.cumulative(np.linspace(0.0, 1.0, points)) @ np.column_stack([x, y])


def constant_inertia(link: StrainLink, at: Points | None = None) -> ca.SX:
    """What is constant in the inertia for rates (omega, v), (1 + n, 1 + n): the straight link's integrals less their
    quadrature (by its own points unless `at` others), and the turning of the sections.
    """
    beam, basis = link.beam, link.basis
    exact = _rest_inertia(basis)
    lacking = exact - _inertia(basis, at or link.points, np.zeros(basis.n))
    size = np.sqrt(np.diag(exact))
    lacking = np.where(np.abs(lacking) > 1e-13 * np.outer(size, size), lacking, 0.0)
    unit = ca.vertcat(beam.length, *[1.0] * basis.n)
    per_area = beam.I_z / beam.area / beam.length**2
    return beam.mass * (ca.SX(ca.DM(lacking)) + per_area * ca.DM(_turning(basis))) * (unit @ unit.T)


def _turning(basis: Basis) -> Array:
    """int (omega + theta')^2 for rates (omega, v), length 1; without shear sections turn by the slope."""
    first = basis.tip if basis.rotary_first is None else basis.rotary_first
    square = basis.shortening if basis.rotary is None else basis.rotary
    return np.block([[np.ones((1, 1)), first[None]], [first[:, None], square]])


def _rest_inertia(basis: Basis) -> Array:
    """The exact inertia of a straight link about its root, length and mass 1, for rates (omega, v)."""
    mass = basis.mass if basis.along is None else basis.mass + basis.along
    return np.block([[np.full((1, 1), 1 / 3), basis.moment[None]], [basis.moment[:, None], mass]])


def elastic_link(kinematics: str, beam: Beam, basis: Basis) -> ElasticLink:
    """The link of a kinematics: "strain", "stiffened", or without shortening."""
    if kinematics == "strain":
        return StrainLink(beam, basis, True)
    return ElasticLink(beam, basis, kinematics == "stiffened")

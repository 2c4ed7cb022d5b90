"""Energies of an elastic beam whose root moves in the plane, in the frame of the root.

The point at x = L xi of the undeformed beam stands at (x - s, u): deflection u = phi(xi) . q and shortening
s = (1/2) int_0^x u'^2 dx = q . S(xi) q / (2 L), kept to second order ("stiffened") or left out ("linear").
All modal integrals are dimensionless; see `shape_functions.Basis`. A Timoshenko basis adds shear and the turning
of the sections.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from .legendre_ritz import StrainShapes
from .payload import Payload
from .section import Beam
from .shape_functions import Basis


def _dot(a: np.ndarray, q: ca.SX) -> ca.SX:
    return ca.dot(ca.DM(a), q) if len(a) else ca.SX(0)


def _quadratic(q: ca.SX, S: np.ndarray, r: ca.SX) -> ca.SX:
    """q . S r for a constant symmetric S: only entries above rounding of what is largest in their row and column."""
    size = np.sqrt(np.abs(S).max(axis=0, initial=0.0))
    tidy = np.where(np.abs(S) > 1e-14 * np.outer(size, size), S, 0.0)
    return ca.dot(q, ca.sparsify(ca.DM(tidy)) @ r) if len(S) else ca.SX(0)


@dataclass(frozen=True)
class ElasticLink:
    """A beam with its shape functions; `stiffened` keeps the second-order shortening."""

    beam: Beam
    basis: Basis
    stiffened: bool

    def deflection(self, q: ca.SX) -> ca.SX:
        """Tip deflection u(L) [m], across the root's direction."""
        return _dot(self.basis.tip, q)

    def deflection_rate(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """du(L)/dt [m/s]."""
        return _dot(self.basis.tip, v)

    def slope(self, q: ca.SX) -> ca.SX:
        """Turn of the tip's section [rad], u'(L) without shear; linear, so it serves rates too."""
        return _dot(self.basis.tip_slope, q) / self.beam.length

    def root_curvature(self, q: ca.SX) -> ca.SX:
        """Curvature at the root [1/m], u''(0), or psi'(0) with shear: strain over distance from the neutral axis."""
        phi = self.basis.phi
        bent = phi.rotation(0.0, 1) if isinstance(phi, StrainShapes) else phi(0.0, 2)
        return _dot(np.asarray(bent).reshape(-1), q) / self.beam.length**2

    def shortening(self, q: ca.SX) -> ca.SX:
        """Tip shortening s(L) [m]."""
        return _quadratic(q, self.basis.shortening, q) / (2 * self.beam.length) if self.stiffened else ca.SX(0)

    def shortening_rate(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """ds(L)/dt [m/s]."""
        return _quadratic(q, self.basis.shortening, v) / self.beam.length if self.stiffened else ca.SX(0)

    def tip(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Tip position (x, y) [m] in the root frame."""
        return self.beam.length - self.shortening(q), self.deflection(q)

    def tip_velocity(self, root: tuple[ca.SX, ca.SX], omega: ca.SX, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Velocity (x, y) [m/s] of the tip, in root-frame axes, when the root moves at `root` and turns at omega."""
        x, y = self.tip(q)
        return root[0] - self.shortening_rate(q, v) - omega * y, root[1] + self.deflection_rate(q, v) + omega * x

    def centre(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """First moment (int x dm, int y dm) [kg m] in the root frame."""
        L, m = self.beam.length, self.beam.mass
        x = m * L / 2
        if self.stiffened:
            x = x - m / (2 * L) * _quadratic(q, self.basis.shortening_mean, q)
        return x, m * _dot(self.basis.first, q)

    def kinetic_energy(self, root: tuple[ca.SX, ca.SX], omega: ca.SX, q: ca.SX, v: ca.SX) -> ca.SX:
        """T [J]; root velocity (x, y) [m/s] in root-frame axes, frame rate omega [rad/s]."""
        L, m, basis = self.beam.length, self.beam.mass, self.basis
        x, y = self.centre(q)
        x_rate, y_rate = ca.SX(0), m * _dot(basis.first, v)
        second = m * L**2 / 3 + m * _quadratic(q, basis.mass, q)
        if self.stiffened:
            x_rate = -m / L * _quadratic(q, basis.shortening_mean, v)
            second = second - m * _quadratic(q, basis.shortening_moment, q)
        turning = m * L * _dot(basis.moment, v)
        if basis.rotary is not None and basis.rotary_first is not None:
            per_area = self.beam.I_z / self.beam.area
            second = second + m * per_area
            turning = turning + m * per_area / L * _dot(basis.rotary_first, v)
            turning_within = m * per_area / L**2 * _quadratic(v, basis.rotary, v) / 2
        else:
            turning_within = ca.SX(0)
        return (
            m * (root[0] ** 2 + root[1] ** 2) / 2
            + root[0] * (x_rate - omega * y)
            + root[1] * (y_rate + omega * x)
            + omega**2 * second / 2
            + omega * turning
            + m * _quadratic(v, basis.mass, v) / 2
            + turning_within
        )

    def centreline(self, q: np.ndarray, points: int) -> np.ndarray:
        """Points (points, 2) [m] from root to tip in the root frame, for numeric deflections q (n,)."""
        L = self.beam.length
        xi = np.linspace(0.0, 1.0, points)
        line = np.column_stack([L * xi, self.basis.phi(xi) @ q])
        if self.stiffened:  # shortening: half the integral of the slope squared, by Gauss's rule between the points
            node, weight = np.polynomial.legendre.leggauss(6)
            width = 1.0 / (points - 1)
            at, phi = xi[:-1, None] + width * (1 + node) / 2, self.basis.phi
            density = (phi(at, 1) @ q / L) ** 2
            if isinstance(phi, StrainShapes):
                density -= (phi.shear_strain(at) @ q / L) ** 2
            line[1:, 0] -= L / 2 * np.cumsum(density @ weight * width / 2)
        return line

    def strain_energy(self, q: ca.SX) -> ca.SX:
        """(1/2) int E I u''^2 dx [J]; with shear (1/2) int (E I psi'^2 + kappa G A (u' - psi)^2) dx, and so on."""
        beam, basis = self.beam, self.basis
        bent = beam.EI / beam.length**3 * _quadratic(q, basis.stiffness, q) / 2
        if basis.shear is None:
            return bent
        bent += beam.shear_stiffness / beam.length * _quadratic(q, basis.shear, q) / 2
        return (
            bent
            if basis.stretch is None
            else bent + beam.E * beam.area / beam.length * _quadratic(q, basis.stretch, q) / 2
        )

    def dissipation(self, v: ca.SX) -> ca.SX:
        """Rayleigh function [W] of the Kelvin-Voigt damping."""
        return self.beam.damping * self.strain_energy(v)


def second_derivative(e: ca.SX, q: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
    """d2e/dt2 of an expression of q alone, at rates v and accelerations a (n,)."""
    return ca.jtimes(ca.jtimes(e, q, v), q, v) + ca.jtimes(e, q, a)


def payload_energy(payload: Payload, tip: tuple[ca.SX, ca.SX], rate: ca.SX, slope: ca.SX, carried: bool) -> ca.SX:
    """T [J] of a rigid payload on a tip that moves at `tip` (root-frame axes) and turns at `rate`.

    Its mass centre stands at payload.offset in axes turned by `slope`; `carried` says that the offset is not zero.
    """
    vx, vy = tip
    if carried:
        ox, oy = payload.offset[0], payload.offset[1]
        c, s = ca.cos(slope), ca.sin(slope)
        vx, vy = vx - rate * (s * ox + c * oy), vy + rate * (c * ox - s * oy)
    return payload.mass * (vx**2 + vy**2) / 2 + payload.inertia_z * rate**2 / 2


def payload_position(payload: Payload, tip: tuple[ca.SX, ca.SX], slope: ca.SX, carried: bool) -> tuple[ca.SX, ca.SX]:
    """Mass centre (x, y) [m] of the payload in the root frame."""
    x, y = tip
    if carried:
        ox, oy = payload.offset[0], payload.offset[1]
        c, s = ca.cos(slope), ca.sin(slope)
        x, y = x + c * ox - s * oy, y + s * ox + c * oy
    return x, y

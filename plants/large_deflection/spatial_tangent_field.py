"""A beam in space whose rotation field is exact: bending in two planes by a rotation vector, then torsion.

A section's frame is F = R_z(root angle) exp(Phi) R_x(a) with Phi = (0, beta, gamma): beta bends out of the plane (about
y), gamma in it (about z). The strains [1/L], with ' = d/dxi, X = beta gamma' - gamma beta', C = (1 - cos phi)/phi^2,
G = (phi - sin phi)/phi^3, phi = |Phi|, are

    k = (a' - C X, beta' + G gamma X, gamma' - G beta X),  bending measured in axes turned back by a.

The twist strain a' - C X, not a, is expanded in shapes, so that no combination of bends strains the beam in torsion
unless it does: a(xi) = twist shapes . q + int_0^xi C X.

Valid    any rotation of a section against the root below one turn, phi < 2 pi; the root turns at will
Source   right Jacobian of the rotation vector; strains are those of the special Cosserat rod, inextensible and
         unshearable
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.exact_rotations.quadrature import Array, Points, sparse

from .cross_sections import payload_tensor, rotation, series, spin, turned_about_z
from .tangent_field import Rotations, TangentField
from .torsion import TorsionShapes


def _turned_tangent() -> tuple[ca.SX, ca.SX]:
    """Symbols (root angle, beta, gamma) and the tangent R_z exp(Phi) e_x."""
    a = ca.SX.sym("a", 3)
    z = a[1] ** 2 + a[2] ** 2
    along, S = 1 - z * series(z, 2), 1 - z * series(z, 3)
    c, s = ca.cos(a[0]), ca.sin(a[0])
    y = S * a[2]
    return a, ca.vertcat(c * along - s * y, s * along + c * y, -S * a[1])


def _about_x(angle: ca.SX) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


@dataclass(frozen=True, eq=False)
class SpatialSections:
    """q = [root angle where it turns, in-plane bends, out-of-plane bends, twists]."""

    beam: Beam
    payload: Payload
    bend: Rotations  # about z; shape 0 is the root angle where the root turns
    flap: Rotations  # about y
    twist: TorsionShapes
    at: Points

    @property
    def n(self) -> int:
        """How many coordinates."""
        return self.bend.n + self.flap.n + self.twist.n

    def _rows(self, xi: Array, derivative: int = 0) -> tuple[Array, Array, Array, Array]:
        """Root angle, beta, gamma and twist at xi (k,), or their slopes, each times q: (k, n)."""
        parts = [np.zeros((len(xi), self.n)) for _ in range(4)]
        own = [shape.curvature if derivative else shape for shape in (self.bend, self.flap)]
        turns, b, f = int(self.bend.rotating), self.bend.n, self.flap.n
        bent = own[0](xi)
        parts[0][:, :turns] = bent[:, :turns]
        parts[2][:, turns:b] = bent[:, turns:]
        parts[1][:, b : b + f] = own[1](xi)
        parts[3][:, b + f :] = self.twist(xi, derivative)
        return parts[0], parts[1], parts[2], parts[3]

    def field(self) -> TangentField:
        """The tangents."""
        a, t = _turned_tangent()
        rows = self._rows(self.at.xi)[:3]
        if not self.bend.rotating:
            return TangentField(self.at, a[1:], ca.substitute(t, a[0], 0), rows[1:])
        return TangentField(self.at, a, t, rows)

    @property
    def _round(self) -> bool:
        """Whether all axes across a section are alike, so that a turns nothing that matters."""
        y, z = self.beam.I_y, self.beam.I_z
        return not (is_symbolic(y) or is_symbolic(z)) and y == z

    def _strains(self, q: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """At the points: beta', gamma', bending k_y, k_z in the section's axes (a round one's: turned back by a, where
        its energy is the same), and a with the tip's as last entry."""
        _, beta, gamma, twist = (sparse(R) @ q for R in self._rows(self.at.xi))
        _, beta_s, gamma_s, _ = (sparse(R) @ q for R in self._rows(self.at.xi, 1))
        z = beta**2 + gamma**2
        X = beta * gamma_s - gamma * beta_s
        reach = self.at.cumulative(np.append(self.at.xi, 1.0))
        last = sparse(self._rows(np.ones(1))[3]) @ q
        a = ca.vertcat(twist, last) + ca.DM(reach) @ (series(z, 2) * X)
        G = series(z, 3)
        ky, kz = beta_s + G * gamma * X, gamma_s - G * beta * X
        if self._round:
            return beta_s, gamma_s, ky, kz, a
        c, s = ca.cos(a[:-1]), ca.sin(a[:-1])
        return beta_s, gamma_s, c * ky + s * kz, c * kz - s * ky, a

    def _plain(self, q: ca.SX) -> ca.SX:
        """Strain energy of small rotations: what is quadratic in q."""
        beam, b, f = self.beam, self.bend.n, self.flap.n
        stiff = ca.bilin(sparse(self.bend.stiffness), q[:b], q[:b]) * beam.EI
        stiff += ca.bilin(sparse(self.flap.stiffness), q[b : b + f], q[b : b + f]) * beam.E * beam.I_y
        stiff += ca.dot(ca.DM(self.twist.stiffness), q[b + f :] ** 2) * beam.GJ
        return stiff / beam.length / 2

    def strain_energy(self, q: ca.SX) -> ca.SX:
        """(1/2) int E I_z k_z^2 + E I_y k_y^2 + G J (twist strain)^2 ds [J]."""
        beam = self.beam
        beta_s, gamma_s, ky, kz, _ = self._strains(q)
        more = beam.EI * (kz**2 - gamma_s**2) + beam.E * beam.I_y * (ky**2 - beta_s**2)
        return self._plain(q) + ca.dot(ca.DM(self.at.weight), more) / beam.length / 2

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Rayleigh function [W] of the Kelvin-Voigt damping."""
        beam = self.beam
        strains = self._strains(q)
        beta_s, gamma_s, ky, kz, a = (ca.jtimes(k, q, v) for k in strains)
        if self._round:  # the fibres of axes that turn on at a' strain at k' + a' x k
            ky, kz = ky + a[:-1] * strains[3], kz - a[:-1] * strains[2]
        more = beam.EI * (kz**2 - gamma_s**2) + beam.E * beam.I_y * (ky**2 - beta_s**2)
        return beam.damping * (self._plain(v) + ca.dot(ca.DM(self.at.weight), more) / beam.length / 2)

    def elastic_force(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """-(dV/dq + dD/dv), (n,)."""
        force = -ca.gradient(self.strain_energy(q), q)
        damped = is_symbolic(self.beam.damping) or self.beam.damping != 0.0
        return force - ca.gradient(self.dissipation(q, v), v) if damped else force

    def _spins(self, q: ca.SX, v: ca.SX) -> list[tuple[ca.SX, ca.SX, ca.SX]]:
        """Of each section in order of the points, then of the payload, in the axes of a frame in which its inertia J
        stays constant: angular velocity (3,), that of the frame, and J [kg m^2], times the weight for a section."""
        xi = np.append(self.at.xi, 1.0)
        angles = [sparse(R) @ q for R in self._rows(xi)]
        rates = [sparse(R) @ v for R in self._rows(xi)]
        a = self._strains(q)[4]
        a_rate, inertias = ca.jtimes(a, q, v), self._inertias()
        spins = []
        for k in range(len(xi)):
            Phi, rate = ca.vertcat(0, angles[1][k], angles[2][k]), ca.vertcat(0, rates[1][k], rates[2][k])
            turn = spin(Phi, rate) + rotation(Phi).T @ ca.vertcat(0, 0, rates[0][k])
            own = ca.vertcat(a_rate[k], 0, 0)
            J = inertias[k]
            if self._round and k < len(self.at.xi):
                spins.append((turn + own, turn, J))
            elif not J.is_zero():
                turn = _about_x(a[k]).T @ turn + own
                spins.append((turn, turn, J))
        return spins

    def _inertias(self) -> list[ca.SX]:
        """rho L weight diag(I_x, I_y, I_z) [kg m^2] of every point, then the payload's tensor."""
        beam = self.beam
        section = ca.diag(ca.vertcat(ca.SX(beam.polar_moment), beam.I_y, beam.I_z)) * beam.density * beam.length
        return [float(w) * section for w in self.at.weight] + [payload_tensor(self.payload)]

    def kinetic(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """T [J] of all rotations: the sections' and the payload's about its mass centre."""
        return sum((ca.bilin(J, w, w) / 2 for w, _, J in self._spins(q, v)), ca.SX(0))

    def inertia(self, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(M, r) of the same: M = sum G^T J G, r = -sum G^T (J w' + frame spin x J w), w = G v."""
        n = q.shape[0]
        M, r = ca.SX.zeros(n, n), ca.SX.zeros(n)
        for w, frame, J in self._spins(q, v):
            G = ca.jacobian(w, v)
            M += G.T @ (J @ G)
            r -= G.T @ (J @ ca.jtimes(w, q, v) + ca.cross(frame, J @ w))
        return M, r

    def _tip_frame(self, q: ca.SX) -> ca.SX:
        """F of the tip, (3, 3)."""
        h, beta, gamma, _ = (sparse(R) @ q for R in self._rows(np.ones(1)))
        return turned_about_z(h) @ rotation(ca.vertcat(0, beta, gamma)) @ _about_x(self._strains(q)[4][-1])

    def carried(self, q: ca.SX) -> ca.SX:
        """The payload's mass centre from the tip (3,) [m], inertial axes."""
        return self._tip_frame(q) @ ca.vertcat(*self.payload.offset)

    def tip_rotation(self, q: ca.SX) -> ca.SX:
        """Root angle plus the z-component of the tip's rotation vector [rad]: in the plane, the section's rotation."""
        h, _, gamma, _ = (sparse(R) @ q for R in self._rows(np.ones(1)))
        return h + gamma

    def tip_twist(self, q: ca.SX) -> ca.SX:
        """a at the tip [rad]."""
        return self._strains(q)[4][-1]

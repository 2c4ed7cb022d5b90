"""What the sections of a beam add to its axis: rotary inertia, strain energy, and how a payload sits on the tip.

In the plane a section's rotation is linear in the coordinates, and all this is constant matrices. For space, see
`spatial_tangent_field` and `spatial_sub_beam_chain`; the rotation vectors that both use are here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.exact_rotations.quadrature import Array, sparse

TERMS = 16  # of the series in phi^2: complete to rounding below one turn


@dataclass(frozen=True, eq=False)
class PlanarSections(OwnsArrays):
    """Rotation theta = psi . q: K = int psi' psi'^T, S = int psi psi^T, tip_turn = psi(1)."""

    beam: Beam
    payload: Payload
    K: Array
    S: Array
    tip_turn: Array

    def strain_energy(self, q: ca.SX) -> ca.SX:
        """(1/2) int E I theta_s^2 ds [J]."""
        return self.beam.EI / self.beam.length * ca.bilin(sparse(self.K), q, q) / 2

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Rayleigh function [W] of the Kelvin-Voigt damping."""
        return self.beam.damping * self.strain_energy(v)

    def elastic_force(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """-(dV/dq + dD/dv), (n,)."""
        return -self.beam.EI / self.beam.length * (sparse(self.K) @ (q + self.beam.damping * v))

    def _inertia(self) -> ca.SX:
        turn = ca.DM(self.tip_turn)
        own = self.beam.density * self.beam.I_z * self.beam.length * ca.DM(self.S)
        return own + self.payload.inertia_z * (turn @ turn.T)

    def kinetic(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """T [J] of all rotations: the sections' and the payload's about its mass centre."""
        return ca.bilin(self._inertia(), v, v) / 2

    def inertia(self, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(M, r) of the same."""
        return self._inertia(), ca.SX.zeros(q.shape[0])

    def carried(self, q: ca.SX) -> ca.SX:
        """The payload's mass centre from the tip (2,) [m], inertial axes."""
        angle = self.tip_rotation(q)
        c, s = ca.cos(angle), ca.sin(angle)
        x, y, _ = self.payload.offset
        return ca.vertcat(c * x - s * y, s * x + c * y)

    def tip_rotation(self, q: ca.SX) -> ca.SX:
        """Rotation of the tip's section about z [rad]."""
        return ca.dot(ca.DM(self.tip_turn), q)


def series(z: ca.SX, first: int) -> ca.SX:
    """sum_k (-z)^k / (2 k + first)!."""
    total = ca.SX(0)
    for k in reversed(range(TERMS)):
        total = 1 / math.factorial(2 * k + first) - z * total
    return total


def rotation(theta: ca.SX) -> ca.SX:
    """exp of a rotation vector, (3, 3)."""
    z, cross = ca.sumsqr(theta), ca.skew(theta)
    return ca.SX.eye(3) + (1 - z * series(z, 3)) * cross + series(z, 2) * cross @ cross


def spin(theta: ca.SX, rate: ca.SX) -> ca.SX:
    """Angular velocity (3,) in its own axes of the frame exp(theta)."""
    z, across = ca.sumsqr(theta), ca.cross(theta, rate)
    return rate - series(z, 2) * across + series(z, 3) * ca.cross(theta, across)


def payload_tensor(payload: Payload) -> ca.SX:
    """Inertia about the mass centre (3, 3) [kg m^2]."""
    if isinstance(payload.inertia, tuple):
        return ca.SX(ca.vertcat(*[ca.horzcat(*row) for row in payload.inertia]))
    return payload.inertia * ca.SX.eye(3)


def turned_about_z(angle: ca.SX) -> ca.SX:
    """Rotation about z, (3, 3)."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))

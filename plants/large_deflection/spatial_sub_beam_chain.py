"""The chain of sub-beams in space: two planes of bending and torsion in each floating frame.

Frame i has orientation A_i; the tangent in it is A_i (1 - (v'^2 + w'^2)/2, v', w'). A section stands at A_i exp(theta)
with theta = (twist, -w', v') small, and joined sections share their orientation: A_(i+1) = A_i exp(theta_out,i)
exp(-theta_in,i+1). A section's spin is that of its frame plus theta', to first order as in the paper's Eq (14).

Valid    rotations within a sub-beam small; frames turn at will
Source   "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Eqs (1)-(14)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.exact_rotations.quadrature import Array, Points, points
from pliant.plants.exact_rotations.tangent_sums import DifferentiatedTangents

from .cross_sections import payload_tensor, rotation, spin, turned_about_z
from .sub_beam_chain import Chain


@dataclass(frozen=True, eq=False)
class SpatialChain:
    """q = [root angle where it turns, bends, flaps (about y), twists], each sub-beam by sub-beam."""

    beam: Beam
    payload: Payload
    chain: Chain  # the bends
    twists: int
    m: int  # points on each sub-beam

    @property
    def n(self) -> int:
        """How many coordinates."""
        return self.chain.n + self.chain.segments * (self.chain.modes + self.twists)

    @cached_property
    def points(self) -> Points:
        """The points of the whole beam."""
        return points(self.m, self.chain.segments)

    def _twist(self, xi: Array, derivative: int = 0) -> Array:
        """Torsion shapes of a sub-beam at xi (k,), (k, twists): unit twist, then sines; none turns the frame."""
        k = np.pi * np.arange(1, self.twists)
        turned = np.multiply.outer(xi, k)
        if derivative:
            return np.column_stack([np.ones_like(xi), k * np.cos(turned)])[:, : self.twists]
        mean, sines = 0.5, (1 - np.cos(k)) / np.where(k == 0, 1, k)
        if self.chain.frame == "tangent":
            mean, sines = 0.0, 0 * k
        return np.column_stack([xi - mean, np.sin(turned) - sines])[:, : self.twists]

    def _slopes(self, xi: Array, derivative: int = 0) -> Array:
        """Bending slopes of a sub-beam in its frame at xi (k,), or their derivatives: (k, modes)."""
        shapes = self.chain.shapes
        return shapes(xi, 1 + derivative) - (0 if derivative else shapes.offset(self.chain.frame))

    def _own(self, q: ca.SX, i: int) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Sub-beam i's twists, flaps and bends."""
        chain, t = self.chain, self.twists
        flaps, twists = chain.n, chain.n + chain.segments * chain.modes
        columns = slice(flaps + i * chain.modes, flaps + (i + 1) * chain.modes)
        return q[twists + i * t : twists + (i + 1) * t], q[columns], q[chain.columns(i)]

    def _turned(self, q: ca.SX, i: int, xi: float) -> ca.SX:
        """theta (3,) of sub-beam i at xi; linear, so it serves rates too."""
        at = np.array([xi])
        slope = ca.DM(self._slopes(at))
        twist, flap, bend = self._own(q, i)
        return ca.vertcat(ca.DM(self._twist(at)) @ twist if self.twists else 0, slope @ flap, slope @ bend)

    def _frames(self, q: ca.SX, v: ca.SX) -> tuple[list[ca.SX], list[ca.SX]]:
        """Orientation A_i and spin in its own axes of every frame, then of the tip's section."""
        A, w = ca.SX.eye(3), ca.SX.zeros(3)
        if self.chain.rotating:
            A, w = turned_about_z(q[0]), ca.vertcat(0, 0, v[0])
        frames, spins = [], []
        for i in range(self.chain.segments):
            theta, rate = -self._turned(q, i, 0.0), -self._turned(v, i, 0.0)
            A, w = A @ rotation(theta), rotation(theta).T @ w + spin(theta, rate)
            frames.append(A)
            spins.append(w)
            theta, rate = self._turned(q, i, 1.0), self._turned(v, i, 1.0)
            A, w = A @ rotation(theta), rotation(theta).T @ w + spin(theta, rate)
        return [*frames, A], [*spins, w]

    def tangents(self, q: ca.SX) -> ca.SX:
        """t (3, points)."""
        frames, _ = self._frames(q, q)
        slope = ca.DM(self._slopes(points(self.m).xi))
        found = []
        for i in range(self.chain.segments):
            _, flap, bend = self._own(q, i)
            y, z = slope @ bend, -slope @ flap
            found.append(frames[i] @ ca.horzcat(1 - (y**2 + z**2) / 2, y, z).T)
        return ca.horzcat(*found)

    def at(self, q: ca.SX, v: ca.SX) -> DifferentiatedTangents:
        """The tangents and their derivatives at coordinates q and rates v (n,)."""
        return DifferentiatedTangents(self.points, self.tangents(q), q, v)

    def values(self, q: Array) -> Array:
        """t (points, 3) at numeric q."""
        symbol = ca.SX.sym("q", self.n)
        return np.asarray(ca.Function("t", [symbol], [self.tangents(symbol)])(q)).T

    @cached_property
    def _integrals(self) -> list[tuple[Array, Array, Array]]:
        """int psi, int psi psi^T and int psi' psi'^T over a sub-beam, of its twists, flaps and bends."""
        fine = points(4 * max(self.chain.modes, self.twists) + 12)
        found = []
        for shapes in (self._twist, self._slopes, self._slopes):
            psi, slope = shapes(fine.xi), shapes(fine.xi, 1)
            w = fine.weight[:, None]
            found.append((fine.weight @ psi, psi.T @ (w * psi), slope.T @ (w * slope)))
        return found

    def strain_energy(self, q: ca.SX) -> ca.SX:
        """Bending in both planes and torsion [J]."""
        beam, total = self.beam, ca.SX(0)
        for i in range(self.chain.segments):
            for own, (_, _, K), stiffness in zip(
                self._own(q, i), self._integrals, (beam.GJ, beam.E * beam.I_y, beam.EI)
            ):
                total += stiffness * ca.bilin(ca.DM(K), own, own) if own.shape[0] else 0
        return total * self.chain.segments / beam.length / 2

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Rayleigh function [W] of the Kelvin-Voigt damping."""
        return self.beam.damping * self.strain_energy(v)

    def elastic_force(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """-(dV/dq + dD/dv), (n,)."""
        return -ca.gradient(self.strain_energy(q), q) - self.beam.damping * ca.gradient(self.strain_energy(v), v)

    def kinetic(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """T [J] of all rotations: the sections' and the payload's about its mass centre."""
        beam, total = self.beam, ca.SX(0)
        _, spins = self._frames(q, v)
        moments = (beam.polar_moment, beam.I_y, beam.I_z)
        for i in range(self.chain.segments):
            for c, (own, (first, S, _)) in enumerate(zip(self._own(v, i), self._integrals)):
                w = spins[i][c]
                square = w**2
                if own.shape[0]:
                    square += 2 * w * ca.dot(ca.DM(first), own) + ca.bilin(ca.DM(S), own, own)
                total += moments[c] * square
        total *= beam.density * beam.length / self.chain.segments / 2
        return total + ca.bilin(payload_tensor(self.payload), spins[-1], spins[-1]) / 2

    def inertia(self, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(M, r) of the same."""
        T = self.kinetic(q, v)
        momentum = ca.gradient(T, v)
        return ca.jacobian(momentum, v), ca.gradient(T, q) - ca.jtimes(momentum, q, v)

    def carried(self, q: ca.SX) -> ca.SX:
        """The payload's mass centre from the tip (3,) [m], inertial axes."""
        return self._frames(q, q)[0][-1] @ ca.vertcat(*self.payload.offset)

    def tip_rotation(self, q: ca.SX) -> ca.SX:
        """Sum of the rotations about z along the chain [rad]: in the plane, the section's rotation."""
        return ca.dot(ca.DM(self.chain.frame_angles[-1]), q[: self.chain.n])

    def tip_twist(self, q: ca.SX) -> ca.SX:
        """Sum of the sub-beams' twists [rad]."""
        ends = self._twist(np.array([0.0, 1.0]))
        across = ca.DM(ends[1] - ends[0])
        return sum((ca.dot(across, self._own(q, i)[0]) for i in range(self.chain.segments)), ca.SX(0))

"""Sections of a beam in the plane: their angle is linear in the coordinates.

theta = rest + psi . q, dr/ds = (1 + e) t + g n, t = (cos theta, sin theta), n = (-sin theta, cos theta).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants.exact_rotations.quadrature import sparse
from pliant.plants.exact_rotations.tangent_sums import DifferentiatedTangents

from .section_frames import TIP, Motion, SectionFrames


@dataclass(frozen=True, eq=False)
class PlanarFrames(SectionFrames):
    """q = [root_x, root_y, (root angle, bends), stretches, shears], what there is of them."""

    @property
    def d(self) -> int:
        return 2

    def at(self, q: ca.SX, v: ca.SX) -> Motion:
        return PlanarMotion(self, q, v)

    def tangents(self, q: ca.SX) -> ca.SX:
        theta = (self.rest.angle(self.along.xi) + self.strains.turned(q, self.along.xi)).T
        c, s, onward = ca.cos(theta), ca.sin(theta), self.onward(q)
        e, g = onward[0, :], onward[1, :]
        return self.rooted(q, ca.vertcat(c * e - s * g, s * e + c * g))

    def inertial_places(self, q: ca.SX) -> ca.SX:
        """z (k,) with T = |dz/dt|^2/2: places weighed by roots of masses, angles by roots of moments of inertia."""
        beam, load, at = self.beam, self.payload, self.along
        t, root = self.tangents(q), sparse(self.points.root)
        z = [ca.sqrt(beam.mass) * beam.length * (root @ t[c, :].T) for c in range(2)]
        carried = self.tip_frame(q) @ ca.vertcat(*load.offset[:2])
        z.append(ca.sqrt(load.mass) * (beam.length * (t @ ca.DM(self.points.weight)) + carried))
        z.append(ca.sqrt(load.inertia_z) * self.tip_rotation(q))
        if self.turns_with_inertia:
            spun = ca.sqrt(self.rotary * beam.density * beam.I_z * beam.length)
            z.append(spun * ca.DM(np.sqrt(at.weight)) * self.strains.turned(q, at.xi))
        return ca.vertcat(*z)

    def tip_frame(self, q: ca.SX) -> ca.SX:
        angle = self.rest.angle(TIP) + self.tip_rotation(q)
        c, s = ca.cos(angle), ca.sin(angle)
        return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))


class PlanarMotion(DifferentiatedTangents, Motion):
    """Spins are constant rows of the rates."""

    def __init__(self, frames: PlanarFrames, q: ca.SX, v: ca.SX) -> None:
        super().__init__(frames.points, frames.tangents(q), q, v)
        self._frames, self._v, self.frame = frames, v, frames.tip_frame(q)
        turning = np.zeros((1, frames.strains.n))
        turning[:, frames.strains.slices["bend"]] = frames.strains.bend(TIP)
        self.turning = ca.SX(ca.sparsify(ca.DM(turning)))

    def inertia(self) -> tuple[ca.SX, ca.SX]:
        own, beam, at = self._frames, self._frames.beam, self._frames.along
        n, columns = own.strains.n, own.strains.slices["bend"]
        M = own.payload.inertia_z * (self.turning.T @ self.turning)
        if own.turns_with_inertia:
            psi = own.strains.bend(at.xi)
            turning = psi.T @ (at.weight[:, None] * psi)
            M[columns, columns] += own.rotary * beam.density * beam.I_z * beam.length * ca.DM((turning + turning.T) / 2)
        return ca.densify(M), ca.SX.zeros(n)

    def turning_energy(self) -> ca.SX:
        own, beam, at = self._frames, self._frames.beam, self._frames.along
        T = own.payload.inertia_z * (self.turning @ self._v) ** 2 / 2
        if own.turns_with_inertia:
            spins = own.strains.turned(self._v, at.xi)
            T += own.rotary * beam.density * beam.I_z * beam.length * ca.dot(ca.DM(at.weight), spins**2) / 2
        return T

    @property
    def carried_rate(self) -> ca.SX:  # type: ignore[override]
        """Of the payload's mass centre from the tip (2,) [m/s]."""
        return self.carried()[1] @ self._v

    def carried(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        c = self.frame @ ca.vertcat(*self._frames.payload.offset[:2])
        spin = self.turning @ self._v
        return c, ca.vertcat(-c[1], c[0]) @ self.turning, -(spin**2) * c

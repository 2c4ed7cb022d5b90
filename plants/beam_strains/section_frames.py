"""Where the sections of a beam stand, how they turn and what that takes, as far as plane and space are alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.exact_rotations.quadrature import Array, Points
from pliant.plants.exact_rotations.rooted_points import RootedPoints
from pliant.plants.exact_rotations.tangent_sums import TangentSums

from .rest_shape import RestShape
from .strain_fields import StrainFields

TIP = np.ones(1)


class Motion(TangentSums):
    """Of all sections at q, v (n,): their tangents, see `TangentSums`, and the turn of the tip."""

    frame: ca.SX  # axes of the tip's section (d, d), inertial components
    carried_rate: ca.SX  # of the payload's mass centre from the tip (d,) [m/s]
    turning: ca.SX  # G with angular velocity of the tip = G v, inertial axes: (1, n) in the plane, (3, n) in space

    @abstractmethod
    def inertia(self) -> tuple[ca.SX, ca.SX]:
        """(M, r) of all rotations, the sections' and the payload's about its mass centre: M v' = r."""

    @abstractmethod
    def turning_energy(self) -> ca.SX:
        """T [J] of the same, from the spins."""

    @abstractmethod
    def carried(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """The payload's mass centre from the tip, inertial axes: c (d,) [m], dc/dq (d, n), c'' where q'' = 0 (d,)."""


@dataclass(frozen=True, eq=False)
class SectionFrames(ABC):
    """A beam with its strains and its shape at rest; d = 2 or 3 components."""

    beam: Beam
    payload: Payload
    strains: StrainFields
    rest: RestShape
    along: Points
    rotary: Any  # factor of the sections' rotary inertia

    @property
    @abstractmethod
    def d(self) -> int: ...

    @abstractmethod
    def at(self, q: ca.SX, v: ca.SX) -> Motion:
        """All that follows from coordinates q and rates v (n,)."""

    @abstractmethod
    def tangents(self, q: ca.SX) -> ca.SX:
        """dr/ds at the points, the root's position over the length before them where it moves: (d, m) or (d, 1 + m)."""

    @abstractmethod
    def tip_frame(self, q: ca.SX) -> ca.SX:
        """Axes of the tip's section (d, d), inertial components."""

    @cached_property
    def points(self) -> Points:
        """Those of `tangents`."""
        return RootedPoints.of(self.along) if self.strains.travels else self.along

    def rooted(self, q: ca.SX, tangents: ca.SX) -> ca.SX:
        """Tangents (d, m), before them the root's position over the length where it moves."""
        if not self.strains.travels:
            return tangents
        return ca.horzcat(q[self.strains.slices["root"]] / self.beam.length, tangents)

    def tip_rotation(self, q: ca.SX) -> ca.SX:
        """Root angle and integral of the curvature about the sections' z [rad]; zero at rest."""
        return self.strains.turned(q, TIP)

    @property
    def turns_with_inertia(self) -> bool:
        """Whether the sections have rotary inertia."""
        return is_symbolic(self.rotary) or self.rotary != 0.0

    @cached_property
    def _tangents(self) -> ca.Function:
        q = ca.SX.sym("q", self.strains.n)
        return ca.Function("t", [q], [self.tangents(q)])

    def values(self, q: Array) -> Array:
        """The tangents (m, d) at numeric q."""
        return np.asarray(self._tangents(q)).T

    def onward(self, q: ca.SX) -> ca.SX:
        """dr/ds at the points in the sections' axes: (1 + e, g_y, g_z), (d, m)."""
        kinds = ("stretch", "shear_y", "shear_z")[: self.d]
        along, *across = (self.strains.of(kind, q, self.along.xi).T for kind in kinds)
        return ca.vertcat(1 + along, *across)

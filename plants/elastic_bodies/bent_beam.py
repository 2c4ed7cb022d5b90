"""A beam of small slopes as a body of a tree; its integrals are those of `tree_beam`, its forces of `beam_forces`."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants.core.signals import Signal
from pliant.plants.multibody_parts import beam_forces
from pliant.plants.multibody_parts.spatial import Inertia, Motion, Wrench
from pliant.plants.multibody_parts.tree_beam import FAMILIES, Section, TreeBeam

from .elastic_body import ElasticBody, Place


def family_signals(counts: tuple[int, ...]) -> list[Signal]:
    """Coordinates of a beam: bending in x-y and x-z [m], twist [rad], stretch [m]."""
    units = ("m", "m", "rad", "m")
    words = zip(FAMILIES, units, counts, strict=True)
    return [Signal(f"{family}{k + 1}", unit) for family, unit, n in words for k in range(n)]


def centreline(body: ElasticBody, eta: np.ndarray, points: int) -> np.ndarray:
    """Sections of a beam from its root to its end (points, 3) [m]."""
    at, still = ca.SX(ca.DM(eta)), ca.SX.zeros(body.n)
    along = [body.section(float(xi), at, still).shift for xi in np.linspace(0.0, 1.0, points)]
    return np.array([np.array(ca.DM(ca.densify(p))).reshape(3) for p in along])


@dataclass(frozen=True, eq=False)
class BentBeam(ElasticBody):
    """ "linear", "stiffened" or rigid: what `straight` says."""

    straight: TreeBeam

    @property
    def n(self) -> int:
        return self.straight.n

    def inertia(self, eta: ca.SX) -> Inertia:
        return self.straight.inertia(eta)

    def coupling(self, eta: ca.SX) -> list[Wrench]:
        return self.straight.coupling(eta)

    def mass(self, eta: ca.SX) -> ca.SX:
        return self.straight.mass()

    def inertial(self, motion: Motion, U: ca.SX, eta: ca.SX, rate: ca.SX) -> tuple[Wrench, ca.SX]:
        return beam_forces.inertial(self.straight, motion, U, eta, rate)

    def section(self, place: Place, eta: ca.SX, rate: ca.SX) -> Section:
        return self.straight.section(float(place), eta, rate)

    def resistance(self, eta: ca.SX, rate: ca.SX) -> ca.SX:
        return self.straight.stiffness() @ (eta + self.straight.beam.damping * rate)

    def strain_energy(self, eta: ca.SX) -> ca.SX:
        return ca.dot(eta, self.straight.stiffness() @ eta) / 2

    def dissipation(self, rate: ca.SX) -> ca.SX:
        return self.straight.beam.damping * self.strain_energy(rate)

    def readings(self, eta: ca.SX, rate: ca.SX) -> list[ca.SX]:
        own = self.straight
        return [*own.deflection(eta), *own.deflection(rate), *own.curvature(eta)]

    def line(self, eta: np.ndarray, points: int) -> np.ndarray:
        return centreline(self, eta, points)

"""A beam of small slopes as a body of a tree; its integrals are those of `tree_beam`, its forces of `beam_forces`."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from pliant.plants.multibody_parts import beam_forces
from pliant.plants.multibody_parts.spatial import Inertia, Motion, Wrench
from pliant.plants.multibody_parts.tree_beam import Section

from .beam_body import BeamBody
from .elastic_body import Place


@dataclass(frozen=True, eq=False)
class BentBeam(BeamBody):
    """ "linear", "stiffened" or rigid: what `straight` says."""

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

    def readings(self, eta: ca.SX, rate: ca.SX) -> list[ca.SX]:
        own = self.straight
        return [*own.deflection(eta), *own.deflection(rate), *own.curvature(eta)]

"""Springs, gears that give, stops, strain and what damps them, in a tree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from pliant.plants.elastic_bodies.elastic_body import ElasticBody

from .fidelity import TreeFidelity


@dataclass(frozen=True, kw_only=True)
class TreeElasticity(TreeFidelity):
    """Forces that depend on one joint or one beam alone, and their energies."""

    def _beams(self) -> list[tuple[ElasticBody, slice]]:
        found, at = [], len(self.moving) + len(self.motors)
        for _, beam in self.tree.beams:
            found.append((beam, slice(at, at + beam.n)))
            at += beam.n
        return found

    def _twists(self, q: ca.SX) -> list[tuple[int, int, Any, ca.SX]]:
        """(joint, motor, elastic joint, twist of its spring [rad]) of coordinates, or of their rates."""
        n = len(self.moving)
        gears: list[Any] = [self.moving[i].elastic for i in self.motors]
        return [
            (i, n + k, g, q[n + k] / g.ratio - q[i]) for k, (i, g) in enumerate(zip(self.motors, gears, strict=True))
        ]

    def _resistance(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Forces (n,) of strain, springs and damping, against the motion."""
        found = ca.SX.zeros(q.shape[0])
        for i, joint in enumerate(self.moving):
            dry = joint.friction * v[i] / ca.sqrt(v[i] ** 2 + joint.friction_rate**2)
            found[i] = joint.stiffness * (q[i] - joint.rest) + joint.damping * v[i] + dry
            for side, z in joint.beyond(q[i]):
                root = ca.sqrt(z**2 + joint.stop_width**2)
                found[i] += side * joint.stop_stiffness * (z + root) ** 2 / (4 * root)
        for (i, k, gear, twist), (_, _, _, rate) in zip(self._twists(q), self._twists(v), strict=True):
            torque = gear.stiffness * twist + gear.damping * rate
            found[i] -= torque
            found[k] += torque / gear.ratio + gear.rotor_friction * v[k]
        for beam, at in self._beams():
            found[at] = beam.resistance(q[at], v[at])
        return found

    def _spring_energy(self, q: ca.SX) -> ca.SX:
        """Of strain, springs and stops [J]; zero where all coordinates are."""
        V = ca.SX(0)
        for i, joint in enumerate(self.moving):
            V += joint.stiffness * ((q[i] - joint.rest) ** 2 - joint.rest**2) / 2
            for (_, z), (_, z0) in zip(joint.beyond(q[i]), joint.beyond(0.0), strict=True):
                d, d0 = ((s + ca.sqrt(s**2 + joint.stop_width**2)) / 2 for s in (z, z0))
                V += joint.stop_stiffness * (d**2 - d0**2) / 2
        V += sum((gear.stiffness * twist**2 / 2 for _, _, gear, twist in self._twists(q)), ca.SX(0))
        return V + sum((beam.strain_energy(q[at]) for beam, at in self._beams()), ca.SX(0))

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        D = ca.SX(0)
        for i, joint in enumerate(self.moving):
            dry = joint.friction * (ca.sqrt(v[i] ** 2 + joint.friction_rate**2) - joint.friction_rate)
            D += joint.damping * v[i] ** 2 / 2 + dry
        for _, k, gear, rate in self._twists(v):
            D += gear.damping * rate**2 / 2 + gear.rotor_friction * v[k] ** 2 / 2
        for beam, at in self._beams():
            D += beam.dissipation(v[at])
        return D

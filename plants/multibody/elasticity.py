"""Springs, gears that give, stops, strain and what damps them, in a tree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from pliant.plants.elastic_bodies.elastic_body import ElasticBody
from pliant.plants.multibody_joints.freedoms import ends
from pliant.plants.multibody_joints.joint_forces import forces, lost, stored

from .fidelity import TreeFidelity


@dataclass(frozen=True, kw_only=True)
class TreeElasticity(TreeFidelity):
    """Forces that depend on one joint or one beam alone, and their energies."""

    def _beams(self) -> list[tuple[ElasticBody, slice, slice]]:
        """(beam, its coordinates among q, their rates among v)."""
        m = len(self.motors)
        found, (q, v) = [], ends(self.slots)
        for _, beam in self.tree.beams:
            found.append((beam, slice(q + m, q + m + beam.n), slice(v + m, v + m + beam.n)))
            q, v = q + beam.n, v + beam.n
        return found

    def _twists(self, q: ca.SX) -> list[tuple[int, int, Any, ca.SX]]:
        """(speed of the joint, of the motor, elastic joint, twist of its spring [rad]) of coordinates, or of speeds."""
        n = ends(self.slots)
        more = q.shape[0] - n[1] - len(self.motors) - sum(beam.n for _, beam in self.tree.beams)
        found = []
        for k, i in enumerate(self.motors):
            slot, gear = self.slots[i], self.slots[i].joint.elastic
            assert gear is not None
            at = slot.q if more else slot.v
            found.append((slot.v, n[1] + k, gear, q[n[1] + more + k] / gear.ratio - q[at]))
        return found

    def _resistance(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Forces (nv,) of strain, springs and damping, against the motion."""
        found = ca.SX.zeros(v.shape[0])
        for slot in self.slots:
            held = forces(slot, q, v)
            found[slot.v : slot.v + held.shape[0]] = held
        for (i, k, gear, twist), (_, _, _, rate) in zip(self._twists(q), self._twists(v), strict=True):
            torque = gear.stiffness * twist + gear.damping * rate
            found[i] -= torque
            found[k] += torque / gear.ratio + gear.rotor_friction * v[k]
        for beam, at, rates in self._beams():
            found[rates] = beam.resistance(q[at], v[rates])
        return found

    def _spring_energy(self, q: ca.SX) -> ca.SX:
        """Of strain, springs and stops [J]; zero where all coordinates are, and no joint is turned."""
        V = sum((stored(slot, q) for slot in self.slots), ca.SX(0))
        V += sum((gear.stiffness * twist**2 / 2 for _, _, gear, twist in self._twists(q)), ca.SX(0))
        return V + sum((beam.strain_energy(q[at]) for beam, at, _ in self._beams()), ca.SX(0))

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        D = sum((lost(slot, v) for slot in self.slots), ca.SX(0))
        for _, k, gear, rate in self._twists(v):
            D += gear.damping * rate**2 / 2 + gear.rotor_friction * v[k] ** 2 / 2
        for beam, _, at in self._beams():
            D += beam.dissipation(v[at])
        return D

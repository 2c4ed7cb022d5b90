"""Equations of motion of a tree: forces by Newton and Euler, the mass matrix by composite bodies.

Small trees are solved by M = L D L^T, from the leaves to the base; from ARTICULATED speeds on by articulated bodies,
which need no M: a chain of 24 joints takes 44 % of the operations so, one of 12 joints 82 %, one of 6 would take 112 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from pliant.plants.core.casadi_functions import entries, last_call
from pliant.plants.multibody_joints.freedoms import ends, freedoms
from pliant.plants.multibody_parts.spatial import Wrench
from pliant.plants.multibody_recursion.articulated import Articulated
from pliant.plants.multibody_recursion.composite import mass_matrix
from pliant.plants.multibody_recursion.kinematics import weight_energy
from pliant.plants.multibody_recursion.layout import vector
from pliant.plants.multibody_recursion.newton_euler import forces, work
from pliant.plants.multibody_recursion.walk import Walk

from .elasticity import TreeElasticity

ARTICULATED = 12  # speeds: chains of fewer take more operations by articulated bodies


@dataclass(frozen=True, kw_only=True)
class TreeDynamics(TreeElasticity):
    """M(q) q'' + h(q, q') + K q + D q' = B u + sum over frames of J^T w."""

    @last_call
    def _walk(self, q: ca.SX, v: ca.SX) -> Walk:
        (n, k), m = ends(self.slots), len(self.motors)
        return Walk(self.tree, _without(q, n, n + m), _without(v, k, k + m))

    @last_call
    def _walk_at(self, x: ca.SX) -> Walk:
        """The one that all that is asked of a state shares."""
        n = len(self.coordinates)
        return self._walk(x[:n], x[n:])

    def _all(self, inner: ca.SX, motors: list[ca.SX] | None = None) -> ca.SX:
        """(n,) of what the recursion gives, which knows no motors; theirs are zero where they are not told."""
        n = ends(self.slots)[1]
        joints, bent = entries(inner, slice(0, n)), entries(inner, slice(n, inner.shape[0]))
        return ca.vertcat(joints, *(motors or [ca.SX.zeros(len(self.motors))]), bent)

    def inner(self, v: ca.SX) -> ca.SX:
        """Of a speed each, those that the recursion knows: without motors."""
        k = ends(self.slots)[1]
        return _without(v, k, k + len(self.motors))

    def _wrenches(self, walk: Walk, u: ca.SX, w: ca.SX) -> dict[int, Wrench]:
        """Thrusts and disturbances on their places, in these's axes."""
        found, first = dict[int, Wrench](), len(self._inputs)
        for i, one in enumerate(self.thrusters):
            found[self.tree.places[one.frame]] = Wrench(ca.DM(one.direction) * u[first + i], ca.SX.zeros(3))
        for i, place in enumerate(self.loads):
            k = self.tree.places[place]
            load = Wrench(walk.within(k, w[6 * i : 6 * i + 3]), walk.within(k, w[6 * i + 3 : 6 * i + 6]))
            found[k] = found[k] + load if k in found else load
        return found

    def _mass_matrix(self, walk: Walk) -> ca.SX:
        n, m = ends(self.slots)[1], len(self.motors)
        inner = mass_matrix(walk)
        M = ca.SX(inner.shape[0] + m, inner.shape[0] + m)
        at = [*range(n), *range(n + m, M.shape[0])]
        M[at, at] = inner
        for joint, _, v in self.slots:
            M[v, v] += joint.armature
        for k, i in enumerate(self.motors):
            M[n + k, n + k] = self.moving[i].elastic.rotor_inertia  # type: ignore[union-attr]
        return M

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        return ca.dot(v, self._mass_matrix(self._walk(q, v)) @ v) / 2

    def potential_energy(self, q: ca.SX) -> ca.SX:
        return self._stored(self._walk(q, ca.SX.zeros(len(self.speeds))), q)

    def _stored(self, walk: Walk, q: ca.SX) -> ca.SX:
        """The potential energy of a walk at coordinates q; zero where these are."""
        g, zero = vector(self.gravity), ca.SX.zeros(q.shape[0])
        for _, first, _ in self.turns:
            zero[first] = 1
        V = weight_energy(walk, g)
        if q.is_valid_input():  # with numbers put in, it is not walked again
            return V - ca.substitute(V, q, zero) + self._spring_energy(q)
        still = self._walk(zero, ca.SX.zeros(len(self.speeds)))
        return V - weight_energy(still, g) + self._spring_energy(q)

    @property
    def _written_out(self) -> bool:
        return True

    def _driving(self, n: int, u: ca.SX) -> ca.SX:
        force = ca.SX.zeros(n)
        for k, (_, i) in enumerate(self._inputs):
            if i not in self.driven:
                force[i] = u[k]
        return force

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        walk = self._walk(q, v)
        return self._driving(v.shape[0], u) + self._all(work(walk, self._wrenches(walk, u, w)))

    @last_call
    def _forces(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        """r (n,) of M a = r."""
        n = len(self.coordinates)
        q, v, walk = x[:n], x[n:], self._walk_at(x)
        inertial = self._all(forces(walk, vector(self.gravity), self._wrenches(walk, u, w)))
        return self._driving(v.shape[0], u) - self._resistance(q, v) - inertial

    @last_call
    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        n = len(self.coordinates)
        v, walk = x[n:], self._walk_at(x)
        M, r = ca.cse([self._mass_matrix(walk), self._forces(t, x, u, w)])
        return M, r, ca.dot(v, M @ v) / 2, self._stored(walk, x[:n])

    def elimination(self, n: int) -> list[int]:
        """Leaves first: bodies on different branches have no inertia in common (Featherstone, Section 6.4)."""
        (_, joints), m = ends(self.slots), len(self.motors)
        found, walk = list(range(joints, joints + m)), self._walk(*(ca.SX.zeros(k) for k in (len(self.coordinates), n)))
        for k in reversed(range(len(self.tree.nodes))):
            found += [key + m for key in walk.beam_keys.get(k, ())]
            if k in walk.joint_slots:
                slot = walk.joint_slots[k]
                found += range(slot.v, slot.v + len(freedoms(slot.joint)))
        return found

    @last_call
    def solved(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        if len(self.speeds) < ARTICULATED:
            return super().solved(t, x, u, w)
        k = ends(self.slots)[1]
        r = self._forces(t, x, u, w)
        armature = {at: ca.SX(joint.armature) for joint, _, at in self.slots}
        given = {i: u[j] for i, j in self.driven.items()}
        own = Articulated(self._walk_at(x), self.inner(r), armature, given)
        rotors = [ca.SX(self.moving[i].elastic.rotor_inertia) for i in self.motors]  # type: ignore[union-attr]
        motors = [r[k + i] / one for i, one in enumerate(rotors)]
        return self._all(own.accelerations(), motors), [*own.pivots, *rotors]


def _without(v: ca.SX, n: int, m: int) -> ca.SX:
    """A column without entries n to m."""
    return ca.vertcat(entries(v, slice(0, n)), entries(v, slice(m, v.shape[0])))

"""M a = r of a tree without its mass matrix, by articulated bodies: up the tree, each coordinate is eliminated where it
acts; down the tree, each follows from the acceleration of the frame before it. The work grows with the count of bodies.

With U = I s the wrench that a unit acceleration of a coordinate takes of what hangs beyond, about the axis s,

    d = s . U + armature    y = r - s . p    I -= U U^T / d    p += U y / d        a = (y - U . A) / d

where I and p are inertia and force of what hangs beyond, coordinates eliminated, and A is the frame's acceleration. The
coordinates of a body that bends are one block: its mass, and what hangs on its sections through T^T M_s T.

Source   R. Featherstone, "Rigid Body Dynamics Algorithms" (2008), Section 7.3
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import casadi as ca

from pliant.plants.dynamics.symbolic_ldl import ldl
from pliant.plants.elastic_bodies.elastic_body import ElasticBody
from pliant.plants.multibody_parts.articulated_inertia import ArticulatedInertia
from pliant.plants.multibody_parts.spatial import Wrench
from pliant.plants.multibody_parts.steps import Ball, Fixed, Move, Spin, Step

from .composite import Matrix, add_to, at_sections, of_pair
from .layout import BASE
from .walk import UNIT, Walk


class Axis(NamedTuple):
    """What a coordinate moves: along a unit vector (3,), or about it."""

    key: int
    along: ca.SX
    turns: bool
    aligned: int | None  # which axis of the frame that is

    def on(self, load: Wrench) -> ca.SX:
        """s . load."""
        return ca.dot(self.along, load.n if self.turns else load.f)


class Left(NamedTuple):
    """What the way down needs of an eliminated coordinate: a = y - U . A, both over d."""

    axis: Axis
    U: Wrench
    y: ca.SX


class Bent(NamedTuple):
    """Of a body that bends, a = L^-T (y - V A), both over d."""

    L: ca.SX
    V: list[Wrench]
    y: list[ca.SX]


def axes(step: Step) -> list[Axis]:
    """The coordinates that act in a step."""
    if isinstance(step, Fixed):
        return []
    if isinstance(step, Ball):
        return [Axis(key, ca.SX(ca.DM(UNIT[i])), True, i) for i, key in enumerate(step.keys)]
    if isinstance(step, Spin):
        return [Axis(step.acting.key, ca.SX(ca.DM(step.acting.along)), True, step.axis)]
    found = []
    for key, along in step.acting:
        at = [i for i in range(3) if along[i]]
        found.append(Axis(key, ca.SX(ca.DM(along)), False, at[0] if len(at) == 1 else None))
    return found


def _dot(load: Wrench, A: Wrench) -> ca.SX:
    return ca.dot(load.f, A.f) + ca.dot(load.n, A.n)


def _times(factor: ca.SX, load: Wrench) -> Wrench:
    return Wrench(factor * load.f, factor * load.n)


class Articulated:
    """M factored along the tree; `armature` by coordinate, those `given` are not solved for. `pivots` are positive
    where M is definite.
    """

    def __init__(self, walk: Walk, r: ca.SX, armature: Mapping[int, ca.SX], given: Mapping[int, ca.SX]) -> None:
        self.walk, self.r, self.armature, self.given = walk, r, armature, given
        nodes = walk.tree.nodes
        self.pivots = list[ca.SX]()
        self._bodies = [ArticulatedInertia.of(n.inertia) if n.inertia is not None else None for n in nodes]
        self._loads = [Wrench(ca.SX.zeros(3), ca.SX.zeros(3)) for _ in nodes]
        self._columns: list[dict[int, Wrench]] = [{} for _ in nodes]
        self._M, self._forces = Matrix(), dict[int, ca.SX]()  # of sections' shifts and turns
        self._left, self._bent = dict[int, Left](), dict[int, Bent]()
        for k in reversed(range(len(nodes))):
            if self._bodies[k] is not None:
                self._up(k)

    def accelerations(self) -> ca.SX:
        """a (n,)."""
        walk, a = self.walk, ca.SX.zeros(self.walk.v.shape[0])
        found = list[Wrench]()
        for k, (node, edge) in enumerate(zip(walk.tree.nodes, walk.edges, strict=True)):
            A = found[node.parent] if node.parent != BASE else Wrench(ca.SX.zeros(3), ca.SX.zeros(3))
            sections = dict[int, ca.SX]()
            if edge.section is not None and node.parent in walk.beam_keys:
                at = walk.beam_keys[node.parent]
                moved = ca.densify(edge.section.T @ a[at.start : at.stop])
                sections = dict(zip(edge.keys, ca.vertsplit(moved), strict=True))
            for step in edge.steps if node.inertia is not None else ():
                A = _down(step, A)
                for axis in axes(step):
                    value = sections[axis.key] if axis.key in sections else self._value(axis, A)
                    if axis.key < a.shape[0]:
                        a[axis.key] = value
                    more = axis.along * value
                    A = Wrench(A.f, A.n + more) if axis.turns else Wrench(A.f + more, A.n)
            found.append(A)
            if k in self._bent:
                a[list(walk.beam_keys[k])] = ca.vertcat(*self._flexed(self._bent[k], A))
        return a

    def _value(self, axis: Axis, A: Wrench) -> ca.SX:
        if axis.key in self.given:
            return self.given[axis.key]
        left = self._left.get(axis.key)
        return ca.SX(0) if left is None else left.y - _dot(left.U, A)

    @staticmethod
    def _flexed(bent: Bent, A: Wrench) -> list[ca.SX]:
        n = len(bent.y)
        eta = [y - _dot(V, A) for y, V in zip(bent.y, bent.V, strict=True)]
        for i in reversed(range(n)):
            for j in range(i + 1, n):
                eta[i] = eta[i] - bent.L[j, i] * eta[j]
        return eta

    def _up(self, k: int) -> None:
        node = self.walk.tree.nodes[k]
        own, load, beyond, n = self._bodies[k], self._loads[k], self._columns[k], self.walk.v.shape[0]
        assert own is not None
        if node.beam is not None:
            own = own + ArticulatedInertia.of(node.beam.inertia(self.walk.bent(k)[0]))
            if node.beam.n:
                own, load = self._block(k, node.beam, own, load, beyond)
            beyond = {}
        for step in reversed(self.walk.edges[k].steps):
            for axis in reversed(axes(step)):
                if axis.key < n:
                    own, load = self._coordinate(axis, own, load)
                    continue
                for other, column in beyond.items():
                    add_to(self._M, axis.key, other, axis.on(column))
                beyond[axis.key] = unit = own.unit(axis.along, axis.turns)
                add_to(self._M, axis.key, axis.key, axis.on(unit))
                self._forces[axis.key] = axis.on(load)
            own, load = own.lift(step), step.up(load)
            beyond = {key: step.up(column) for key, column in beyond.items()}
        if node.parent == BASE:
            return
        above = self._bodies[node.parent]
        assert above is not None
        self._bodies[node.parent] = above + own
        self._loads[node.parent] = self._loads[node.parent] + load
        self._columns[node.parent] |= beyond

    def _coordinate(self, axis: Axis, own: ArticulatedInertia, load: Wrench) -> tuple[ArticulatedInertia, Wrench]:
        """Inertia and force with a joint's coordinate eliminated."""
        U = own.unit(axis.along, axis.turns)
        if axis.key in self.given:
            return own, load + _times(self.given[axis.key], U)
        armature = self.armature.get(axis.key, ca.SX(0))
        d, y = axis.on(U) + armature, self.r[axis.key] - axis.on(load)
        self.pivots.append(d)
        share, y = _times(1 / d, U), y / d
        self._left[axis.key] = Left(axis, share, y)
        bare = axis.aligned is not None and armature.is_zero()
        still = (axis.turns, axis.aligned) if bare and axis.aligned is not None else None
        return own.without(U, share, still), load + _times(y, U)

    def _block(
        self, k: int, beam: ElasticBody, own: ArticulatedInertia, load: Wrench, beyond: dict[int, Wrench]
    ) -> tuple[ArticulatedInertia, Wrench]:
        """With the coordinates of a body that bends eliminated, and those of its sections, which follow them."""
        walk, (eta, _) = self.walk, self.walk.bent(k)
        T, keys = at_sections(walk, k, beam.n, beyond)
        between = ca.SX.zeros(len(keys), len(keys))
        for i, s in enumerate(keys):
            for j, o in enumerate(keys):
                between[i, j] = of_pair(self._M, s, o)
        L, d = ldl(beam.mass(eta) + T.T @ between @ T)
        self.pivots += d
        V, y = beam.coupling(eta), list[ca.SX]()
        for i, key in enumerate(walk.beam_keys[k]):
            force = self.r[key]
            for r, s in enumerate(keys):
                V[i] = V[i] + _times(T[r, i], beyond[s])
                force -= T[r, i] * self._forces[s]
            y.append(force)
        for i in range(beam.n):
            for j in range(i):
                V[i] = V[i] + _times(-L[i, j], V[j])
                y[i] = y[i] - L[i, j] * y[j]
        shares = [_times(1 / d[i], V[i]) for i in range(beam.n)]
        rest = [y[i] / d[i] for i in range(beam.n)]
        for i in range(beam.n):
            own, load = own.without(V[i], shares[i]), load + _times(rest[i], V[i])
        self._bent[k] = Bent(L, shares, rest)
        return own, load


def _down(step: Step, A: Wrench) -> Wrench:
    """Accelerations (a, alpha) in the frame beyond a step, its coordinates held."""
    if isinstance(step, Move):
        return Wrench(A.f + ca.cross(A.n, step.r), A.n)
    return Wrench(step.within(A.f), step.within(A.n))

"""The ways between the bodies of a tree at coordinates q and rates v, in steps.

A coordinate acts in a step: a joint's by itself, a beam's through the shift and the turn of the section from which
something hangs. So the sections' shifts and turns are coordinates of the recursion, by keys beyond those of q.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, wraps
from itertools import count
from typing import Any, NamedTuple, TypeVar

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import entries
from pliant.plants.multibody_joints.freedoms import Slot, ends, slots
from pliant.plants.multibody_parts.steps import Acting, Array, Ball, Fixed, Move, Spin, Step
from pliant.plants.multibody_parts.tree_beam import Section, tidy

from .layout import BASE, Layout, Node

T = TypeVar("T")
UNIT = np.eye(3)


def once(found: Callable[[Walk], list[T]]) -> Callable[[Walk], list[T]]:
    """What is found of a walk, kept with it."""

    @wraps(found)
    def kept(walk: Walk) -> list[T]:
        if found.__name__ not in walk.kept:
            walk.kept[found.__name__] = found(walk)
        known: list[T] = walk.kept[found.__name__]
        return known

    return kept


class Edge(NamedTuple):
    """The way from a parent to a node."""

    steps: list[Step]
    section: Section | None  # of the parent's beam, from which it starts
    keys: list[int]  # of that section's shift and turn (6)


def _along(axis: tuple[float, ...]) -> tuple[int, float] | None:
    """(which, sign) of a coordinate axis."""
    largest = int(np.argmax(np.abs(axis)))
    return (largest, float(np.sign(axis[largest]))) if np.count_nonzero(axis) == 1 else None


def _aligned(axis: tuple[float, ...]) -> np.ndarray:
    """R (3, 3) whose third column is the axis."""
    first = np.cross(axis, UNIT[int(np.argmin(np.abs(axis)))])
    first = first / np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


@dataclass(frozen=True, eq=False)
class Walk:
    """A tree at coordinates q and speeds v (of joints, then of beams one after the other). Keys are places in v."""

    tree: Layout
    q: ca.SX
    v: ca.SX
    kept: dict[str, Any] = field(default_factory=dict, repr=False)

    @cached_property
    def joint_slots(self) -> dict[int, Slot]:
        """{node: where its joint's coordinates and speeds are}."""
        joints = self.tree.joints
        return dict(zip((k for k, _ in joints), slots([joint for _, joint in joints]), strict=True))

    @cached_property
    def joint_keys(self) -> range:
        """The speeds of all joints."""
        return range(ends(tuple(self.joint_slots.values()))[1])

    @cached_property
    def beam_keys(self) -> dict[int, range]:
        """{node: its beam's coordinates}."""
        found, at = {}, len(self.joint_keys)
        for k, beam in self.tree.beams:
            found[k] = range(at, at + beam.n)
            at += beam.n
        return found

    def bent(self, k: int) -> tuple[ca.SX, ca.SX]:
        """(eta, its rate) of a node's beam."""
        return self._bent[k]

    @cached_property
    def _bent(self) -> list[tuple[ca.SX, ca.SX]]:
        """By node, the very same each time, as a beam knows its last ones again."""
        found, more = [], self.q.shape[0] - self.v.shape[0]
        for k in range(len(self.tree.nodes)):
            at = self.beam_keys.get(k, range(0))
            eta = entries(self.q, slice(at.start + more, at.stop + more))
            found.append((eta, entries(self.v, slice(at.start, at.stop))))
        return found

    @cached_property
    def edges(self) -> list[Edge]:
        """By node."""
        fresh = count(self.v.shape[0])
        return [self._edge(k, node, fresh) for k, node in enumerate(self.tree.nodes)]

    def _edge(self, k: int, node: Node, fresh: count[int]) -> Edge:
        steps: list[Step] = []
        section, keys = None, [next(fresh) for _ in range(6)]
        parent = self.tree.nodes[node.parent] if node.parent != BASE else None
        if parent is not None and parent.beam is not None:
            assert node.station is not None
            section = parent.beam.section(node.station, *self.bent(node.parent))
            acting = tuple(Acting(keys[i], UNIT[i]) for i in range(3) if section.T[i, :].nnz())
            steps.append(Move(section.shift, section.shift_rate, section.shift_bias, acting))
            for i in (2, 1, 0) if node.turned else ():
                if section.T[3 + i, :].nnz():
                    angle, rate = section.turn[i], section.turn_rate[i]
                    own, bias = Acting(keys[3 + i], UNIT[i]), section.twist_bias if i == 0 else None
                    steps.append(Spin(i, ca.cos(angle), ca.sin(angle), rate, own, angle, bias))
        still = ca.SX.zeros(3)
        if not node.r.is_zero():
            steps.append(Move(node.r, still, still))
        if node.joint is not None:
            steps += [*_constant(node.R), *self._moved(self.joint_slots[k]), *_constant(node.own)]
        else:
            steps += _constant(node.R @ node.own)
        return Edge(_folded(steps), section, keys)

    def _moved(self, slot: Slot) -> list[Step]:
        joint, q, v, key = slot.joint, self.q[slot.q :], self.v[slot.v :], slot.v
        if joint.kind == "revolute":
            return _turn(joint.axis, q[0], v[0], key)
        if joint.kind == "prismatic":
            return [_shift([joint.axis], q, v, key)]
        if joint.kind == "planar":
            return [_shift(plane(joint.axis), q, v, key), *_turn(joint.axis, q[2], v[2], key + 2)]
        if joint.kind == "spherical":
            return [Ball(q[:4], v[:3], (key, key + 1, key + 2))]
        return [_shift(UNIT, q, v, key), Ball(q[3:7], v[3:6], (key + 3, key + 4, key + 5))]

    def within(self, k: int, v: ca.SX) -> ca.SX:
        """A vector of the base's axes in those of a node."""
        way = [k]
        while self.tree.nodes[way[-1]].parent != BASE:
            way.append(self.tree.nodes[way[-1]].parent)
        for at in reversed(way):
            for step in self.edges[at][0]:
                v = step.within(v)
        return v


def plane(axis: tuple[float, ...]) -> Array:
    """Two directions (2, 3) across an axis: x and y of z, y and z of x, z and x of y."""
    along = _along(axis)
    if along is not None and along[1] > 0:
        return UNIT[[(along[0] + 1) % 3, (along[0] + 2) % 3]]
    return _aligned(axis).T[:2]


def _shift(directions: Any, q: ca.SX, v: ca.SX, key: int) -> Move:
    """Along constant directions, by as many coordinates."""
    acting = tuple(Acting(key + i, np.array(e)) for i, e in enumerate(directions))
    ways = [ca.SX(ca.DM(one.along)) for one in acting]
    r, rate = (sum((e * by[i] for i, e in enumerate(ways[1:], 1)), ways[0] * by[0]) for by in (q, v))
    return Move(r, rate, ca.SX.zeros(3), acting)


def _turn(axis: tuple[float, ...], q: ca.SX, v: ca.SX, key: int) -> list[Step]:
    """About a constant axis."""
    along = _along(axis)
    if along is not None:
        i, sign = along
        return [Spin(i, ca.cos(q), sign * ca.sin(q), sign * v, Acting(key, sign * UNIT[i]), sign * q)]
    B = _aligned(axis)
    return [*_constant(B), Spin(2, ca.cos(q), ca.sin(q), v, Acting(key, UNIT[2]), q), *_constant(B.T)]


def _folded(steps: list[Step]) -> list[Step]:
    """With one constant turn in the place of several that follow each other."""
    found: list[Step] = []
    for step in steps:
        last = found[-1] if found else None
        if isinstance(step, Fixed) and isinstance(last, Fixed):
            found[-1:] = _constant(np.array(last.R) @ np.array(step.R))
        else:
            found.append(step)
    return found


def _constant(R: np.ndarray) -> list[Step]:
    return [] if np.array_equal(R, UNIT) else [Fixed(tidy(R))]

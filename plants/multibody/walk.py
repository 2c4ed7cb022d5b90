"""The ways between the bodies of a tree at coordinates q and rates v, in steps.

A coordinate acts in a step: a joint's by itself, a beam's through the shift and the turn of the section from which
something hangs. So the sections' shifts and turns are coordinates of the recursion, by keys beyond those of q.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import entries
from pliant.plants.multibody_parts.joint import Joint
from pliant.plants.multibody_parts.steps import Acting, Fixed, Move, Spin, Step
from pliant.plants.multibody_parts.tree_beam import Section, tidy

from .layout import BASE, Layout, Node

UNIT = np.eye(3)


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
    """A tree at coordinates q (joints, then beams one after the other) and rates v."""

    tree: Layout
    q: ca.SX
    v: ca.SX

    @cached_property
    def joint_keys(self) -> dict[int, int]:
        """{node: its joint's coordinate}."""
        return {k: i for i, (k, _) in enumerate(self.tree.joints)}

    @cached_property
    def beam_keys(self) -> dict[int, range]:
        """{node: its beam's coordinates}."""
        found, at = {}, len(self.tree.joints)
        for k, beam in self.tree.beams:
            found[k] = range(at, at + beam.n)
            at += beam.n
        return found

    def bent(self, k: int) -> tuple[ca.SX, ca.SX]:
        """(eta, its rate) of a node's beam."""
        at = self.beam_keys.get(k, range(0))
        where = slice(at.start, at.stop)
        return entries(self.q, where), entries(self.v, where)

    @cached_property
    def edges(self) -> list[Edge]:
        """By node."""
        fresh = count(self.q.shape[0])
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
                    acting, bias = Acting(keys[3 + i], UNIT[i]), section.twist_bias if i == 0 else None
                    steps.append(Spin(i, ca.cos(angle), ca.sin(angle), rate, acting, bias))
        still = ca.SX.zeros(3)
        if not node.r.is_zero():
            steps.append(Move(node.r, still, still))
        if node.joint is not None:
            steps += self._moved(node.joint, self.joint_keys[k], node.R)
            steps += _constant(node.own)
        else:
            steps += _constant(node.R @ node.own)
        return Edge(steps, section, keys)

    def _moved(self, joint: Joint, key: int, R: np.ndarray) -> list[Step]:
        q, v = self.q[key], self.v[key]
        if joint.slides:
            e = np.array(joint.axis)
            direction = ca.SX(ca.DM(e))
            return [*_constant(R), Move(direction * q, direction * v, ca.SX.zeros(3), (Acting(key, e),))]
        along = _along(joint.axis)
        if along is not None:
            axis, sign = along
            acting = Acting(key, sign * UNIT[axis])
            return [*_constant(R), Spin(axis, ca.cos(q), sign * ca.sin(q), sign * v, acting)]
        B = _aligned(joint.axis)
        return [*_constant(R @ B), Spin(2, ca.cos(q), ca.sin(q), v, Acting(key, UNIT[2])), *_constant(B.T)]

    def within(self, k: int, v: ca.SX) -> ca.SX:
        """A vector of the base's axes in those of a node."""
        way = [k]
        while self.tree.nodes[way[-1]].parent != BASE:
            way.append(self.tree.nodes[way[-1]].parent)
        for at in reversed(way):
            for step in self.edges[at][0]:
                v = step.within(v)
        return v


def _constant(R: np.ndarray) -> list[Step]:
    return [] if np.array_equal(R, UNIT) else [Fixed(tidy(R))]

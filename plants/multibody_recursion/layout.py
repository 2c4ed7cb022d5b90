"""The tree as the recursion walks it: bodies parents first, what is fixed to a rigid body made part of it.

A node is a body with a frame of its own, or a place (a tip, a named frame) where forces act and positions are asked
for. `edge` tells how its frame follows from its parent's: from a section of the parent's beam or from the frame itself,
by a constant shift and turn, then by the joint.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.elastic_bodies.elastic_body import ElasticBody, Place
from pliant.plants.elastic_bodies.modal_body import ModalBody, place_on
from pliant.plants.multibody_joints.bases import WORLD
from pliant.plants.multibody_parts.joint import Frame, Joint
from pliant.plants.multibody_parts.spatial import Inertia, upper
from pliant.plants.multibody_parts.tree_beam import tidy
from pliant.plants.multibody_parts.tree_body import TreeBody

Array = np.ndarray
BASE = -1


def turned(rpy: Any) -> Array:
    """R (3, 3) of roll, pitch, yaw about the fixed x, y, z; what is 0 or 1 but for rounding is that."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(np.array(rpy)), np.sin(np.array(rpy))
    X = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    Y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    Z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    R = Z @ Y @ X
    near = np.round(R)
    return np.where(np.abs(R - near) < 4e-16, near, R)


def vector(value: Any) -> ca.SX:
    """A tuple of numbers or symbols."""
    return ca.vertcat(*[ca.SX(v) for v in value])


def rigid_inertia(mass: Any, centre: Any, inertia: Any) -> Inertia:
    """Of a body with `inertia` about its mass centre: P = tr(J) 1/2 - J + m c c^T."""
    m, c = ca.SX(mass), vector(centre)
    rows = inertia if isinstance(inertia, tuple) else ((inertia, 0, 0), (0, inertia, 0), (0, 0, inertia))
    J = ca.vertcat(*[ca.horzcat(*[ca.SX(e) for e in row]) for row in rows])
    P = (J[0, 0] + J[1, 1] + J[2, 2]) / 2 * ca.SX.eye(3) - J + m * c @ c.T
    return Inertia(m, m * c, upper(ca.densify(P)))


def placed(body: Inertia, R: Array, r: ca.SX) -> Inertia:
    """In the axes of a frame that sees its own at r, turned by R."""
    m, S, P = body.m, ca.DM(R) @ body.S, ca.DM(R) @ body.matrix() @ ca.DM(R).T
    return Inertia(m, S + m * r, upper(ca.densify(P + S @ r.T + r @ S.T + m * r @ r.T)))


@dataclass(frozen=True, eq=False)
class Node:
    """A body or a place in the tree."""

    name: str
    parent: int  # another node, or BASE
    station: Place | None  # of the parent's beam, or its node
    turned: bool  # with that section
    r: ca.SX  # (3,) constant shift, in the parent's axes
    R: Array  # constant turn
    joint: Joint | None  # that moves
    own: Array  # constant turn after the joint: to the axes of the beam
    inertia: Inertia | None  # None: a place
    beam: ElasticBody | None = None


@dataclass(frozen=True, eq=False)
class Layout:
    """Nodes in order, the joints that move by their node, and where each place is."""

    nodes: tuple[Node, ...]
    places: dict[str, int]
    root: int = BASE  # the node of the base where it moves

    @property
    def joints(self) -> list[tuple[int, Joint]]:
        return [(k, node.joint) for k, node in enumerate(self.nodes) if node.joint is not None]

    @property
    def beams(self) -> list[tuple[int, ElasticBody]]:
        return [(k, node.beam) for k, node in enumerate(self.nodes) if node.beam is not None and node.beam.n]


@dataclass(frozen=True)
class _Held:
    """Where a body's frame stands: on a node, at a constant place."""

    node: int
    R: Array
    r: ca.SX
    flexible: bool


class _Builder:
    """Puts bodies, the payload and places together."""

    def __init__(self, beam: Any) -> None:
        self._beam, self._nodes = beam, list[Node]()
        self._at = {WORLD: _Held(BASE, np.eye(3), ca.SX.zeros(3), False)}
        self.places = dict[str, int]()

    def stand(self, root: str) -> None:
        """A base that does not move."""
        self._at[root] = self._at[WORLD]

    def add(self, body: TreeBody, parent: str) -> None:
        held, joint = self._at[parent], body.joint
        own = turned(body.beam_rotation) if body.bends else np.eye(3)
        beam = self._beam(body)
        inertia = placed(rigid_inertia(body.mass, body.centre, body.inertia), own.T, ca.SX.zeros(3))
        if not (joint.moves or beam or held.flexible) and held.node != BASE:
            R, r = self._beyond(held, joint)
            old = self._nodes[held.node]
            assert old.inertia is not None
            self._nodes[held.node] = replace(old, inertia=old.inertia + placed(inertia, R, r))
            self._at[body.name] = _Held(held.node, R, r, False)
            return
        at = self._node(body.name, held, joint, own, inertia, beam)
        self._at[body.name] = _Held(at, np.eye(3), ca.SX.zeros(3), beam is not None)

    @staticmethod
    def _beyond(held: _Held, part: Joint | Frame) -> tuple[Array, ca.SX]:
        return held.R @ turned(part.rotation), held.r + ca.DM(held.R) @ vector(part.position)

    def _node(
        self, name: str, held: _Held, part: Joint | Frame, own: Array, inertia: Inertia | None, beam: ElasticBody | None
    ) -> int:
        """A node that hangs where `part` says."""
        joint = part if isinstance(part, Joint) else None
        (R, r), station = self._beyond(held, part), None
        if held.flexible:
            before = self._nodes[held.node].own.T  # positions are given in the body's axes, not in its beam's
            R, r = before @ turned(part.rotation), ca.DM(tidy(before)) @ vector(part.position)
            station = self._place(held, part)
        follows = joint.turned if joint is not None else True
        moving = joint if joint is not None and joint.moves else None
        self._nodes.append(Node(name, held.node, station, follows, r, R, moving, own, inertia, beam))
        return len(self._nodes) - 1

    def _place(self, held: _Held, part: Joint | Frame) -> Place:
        """Where on the body that bends."""
        parent = self._nodes[held.node]
        return place_on(parent.beam.data, parent.name, part) if isinstance(parent.beam, ModalBody) else part.station

    def place(self, frame: Frame) -> None:
        """A place without inertia."""
        self.places[frame.name] = self._node(frame.name, self._at[frame.body], frame, np.eye(3), None, None)

    def load(self, payload: Payload, tip: Frame) -> None:
        """The payload, held at the tip."""
        hung = Joint(
            name="payload",
            kind="fixed",
            position=tip.position,
            rotation=tip.rotation,
            station=tip.station,
            node=tip.node,
        )
        body = TreeBody(
            name="payload of the tree", joint=hung, mass=payload.mass, centre=payload.offset, inertia=payload.inertia
        )
        if not body.weightless:
            self.add(body, tip.body)

    def built(self, root: str) -> Layout:
        return Layout(tuple(self._nodes), self.places, self._at[root].node)


def layout(
    bodies: list[tuple[TreeBody, str]], payload: Payload, tip: Frame, frames: list[Frame], beam: Any, root: str
) -> Layout:
    """The tree of bodies (each with its parent's name), a payload at the tip, and the frames that are places;
    `beam(body)` makes a body's ElasticBody; `root` names the base, which stands on WORLD unless it is one of them.
    """
    builder = _Builder(beam)
    if root not in {body.name for body, _ in bodies}:
        builder.stand(root)
    for body, parent in bodies:
        builder.add(body, parent)
    builder.load(payload, tip)
    for frame in frames:
        builder.place(frame)
    return builder.built(root)

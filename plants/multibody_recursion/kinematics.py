"""Where the nodes of a tree stand and how fast they move, in the base's axes."""

from __future__ import annotations

from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.core.quaternions import of_matrix, product
from pliant.plants.multibody_parts.spatial import AROUND
from pliant.plants.multibody_parts.steps import Ball, Fixed, Move, Spin

from .layout import BASE
from .walk import Walk, once

SLIDING = ("prismatic", "planar", "free")  # joints that shift


class Pose(NamedTuple):
    """R (3, 3) takes components from the node's axes to the base's; p (3,) [m] is its origin."""

    R: ca.SX
    p: ca.SX


class Twist(NamedTuple):
    """omega [rad/s] and the origin's velocity v [m/s], in the node's axes."""

    omega: ca.SX
    v: ca.SX


@once
def poses(walk: Walk) -> list[Pose]:
    """Of every node."""
    found: list[Pose] = []
    for node, edge in zip(walk.tree.nodes, walk.edges, strict=True):
        R, p = Pose(ca.SX.eye(3), ca.SX.zeros(3)) if node.parent == BASE else found[node.parent]
        for step in edge.steps:
            if isinstance(step, Move):
                p = p + R @ step.r
            elif isinstance(step, (Fixed, Ball)):
                R = R @ step.R
            else:
                R = _spun(R, step)
        found.append(Pose(R, p))
    return found


def _spun(R: ca.SX, step: Spin) -> ca.SX:
    i, j = AROUND[step.axis]
    turned = ca.densify(ca.SX(R))
    turned[:, i], turned[:, j] = R[:, i] * step.c + R[:, j] * step.s, R[:, j] * step.c - R[:, i] * step.s
    return turned


def quaternions(walk: Walk) -> list[ca.SX]:
    """(4,) of every node, from its axes to the base's."""
    found: list[ca.SX] = []
    for node, edge in zip(walk.tree.nodes, walk.edges, strict=True):
        q = ca.SX(ca.DM([1, 0, 0, 0])) if node.parent == BASE else found[node.parent]
        for step in edge.steps:
            if isinstance(step, Spin):
                half = ca.SX.zeros(4)
                half[0], half[1 + step.axis] = ca.cos(step.angle / 2), ca.sin(step.angle / 2)
                q = product(q, half)
            elif isinstance(step, Ball):
                q = product(q, step.quaternion)
            elif isinstance(step, Fixed):
                q = product(q, ca.SX(ca.DM(of_matrix(np.array(step.R)))))
        found.append(q)
    return found


@once
def twists(walk: Walk) -> list[Twist]:
    """Of every node."""
    found: list[Twist] = []
    for node, edge in zip(walk.tree.nodes, walk.edges, strict=True):
        omega, v = Twist(ca.SX.zeros(3), ca.SX.zeros(3)) if node.parent == BASE else found[node.parent]
        for step in edge.steps:
            if isinstance(step, Move):
                v = v + ca.cross(omega, step.r) + step.rate
            omega, v = step.within(omega), step.within(v)
            if isinstance(step, Spin):
                turned = ca.SX(omega)
                turned[step.axis] = omega[step.axis] + step.rate
                omega = turned
            elif isinstance(step, Ball):
                omega = omega + step.rate
        found.append(Twist(omega, v))
    return found


def weight_energy(walk: Walk, gravity: ca.SX) -> ca.SX:
    """-int g . p dm [J] over the bodies of a tree whose base stands at 0."""
    V = ca.SX(0)
    for k, (node, pose) in enumerate(zip(walk.tree.nodes, poses(walk), strict=True)):
        if node.inertia is None:
            continue
        body = node.inertia
        if node.beam is not None:
            body = body + node.beam.inertia(walk.bent(k)[0])
        V -= ca.dot(gravity, pose.R @ body.S + body.m * pose.p)
    return V


def drawn(walk: Walk, points: int) -> list[ca.SX]:
    """Lines (3, points) [m]: a beam along its sections, else to what hangs on the body. As many at every state: one to
    what slides also where it stands at its parent's place, one for two places that are the same.
    """
    nodes, found, led = walk.tree.nodes, list[ca.SX](), set[tuple[Any, ...]]()
    stands, along = poses(walk), ca.DM(np.linspace(0.0, 1.0, points)).T
    for k, (node, (R, end)) in enumerate(zip(nodes, stands, strict=True)):
        if node.beam is not None:
            line = node.beam.line(walk.bent(k)[0], points)
            found.append(R @ line + ca.repmat(end, 1, line.shape[1]))
        parent = nodes[node.parent] if node.parent != BASE else None
        if parent is not None and parent.beam is not None:
            continue
        kind = "" if node.joint is None else node.joint.kind
        if k <= walk.tree.root or (parent is None and kind in ("planar", "free")):
            continue  # nothing leads there
        way = (node.parent, *np.array(ca.DM(node.r)).reshape(3), k if kind in SLIDING else BASE)
        if way not in led and (kind in SLIDING or any(way[1:4])):
            led.add(way)
            start = stands[node.parent].p if parent is not None else ca.SX.zeros(3)
            found.append(start @ (1 - along) + end @ along)
    return found


def _numbers(pose: Pose) -> tuple[np.ndarray, np.ndarray]:
    return np.array(ca.DM(pose.R)), np.array(ca.DM(pose.p)).reshape(3)


def in_plane(walk: Walk, normal: int) -> bool:
    """Whether all joints of a walk at numbers move in the plane across an axis of the base: 0, 1, 2 for x, y, z."""
    stands = poses(walk)
    for k, joint in walk.tree.joints:
        if joint.kind in ("spherical", "free"):
            return False
        along = _numbers(stands[k])[0] @ np.array(walk.tree.nodes[k].own).T @ np.array(joint.axis)
        turned = abs(abs(along[normal]) - 1.0) < 1e-6
        if not (abs(along[normal]) < 1e-6 if joint.slides else turned):
            return False
    return True

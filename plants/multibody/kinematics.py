"""Where the nodes of a tree stand and how fast they move, in the base's axes."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.multibody_parts.spatial import AROUND
from pliant.plants.multibody_parts.steps import Fixed, Move, Spin

from .layout import BASE
from .walk import Walk


class Pose(NamedTuple):
    """R (3, 3) takes components from the node's axes to the base's; p (3,) [m] is its origin."""

    R: ca.SX
    p: ca.SX


class Twist(NamedTuple):
    """omega [rad/s] and the origin's velocity v [m/s], in the node's axes."""

    omega: ca.SX
    v: ca.SX


def poses(walk: Walk) -> list[Pose]:
    """Of every node."""
    found: list[Pose] = []
    for node, edge in zip(walk.tree.nodes, walk.edges, strict=True):
        R, p = Pose(ca.SX.eye(3), ca.SX.zeros(3)) if node.parent == BASE else found[node.parent]
        for step in edge.steps:
            if isinstance(step, Move):
                p = p + R @ step.r
            elif isinstance(step, Fixed):
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


def drawn(walk: Walk, points: int) -> list[np.ndarray]:
    """Lines (points, 3) [m] of a walk at numbers: a beam along its sections, else to what hangs on the body."""
    nodes, stands, found = walk.tree.nodes, poses(walk), list[np.ndarray]()
    ends = [np.array(ca.DM(pose.p)).reshape(3) for pose in stands]
    for k, (node, pose) in enumerate(zip(nodes, stands, strict=True)):
        if node.beam is not None:
            eta, rate = walk.bent(k)
            R = np.array(ca.DM(pose.R))
            along = [
                np.array(ca.DM(node.beam.section(float(xi), eta, rate).shift)).reshape(3)
                for xi in np.linspace(0.0, 1.0, points)
            ]
            found.append(ends[k] + np.array(along) @ R.T)
        parent = nodes[node.parent] if node.parent != BASE else None
        if parent is None or parent.beam is None:
            start = ends[node.parent] if parent is not None else np.zeros(3)
            if np.linalg.norm(ends[k] - start) > 0:
                found.append(np.linspace(start, ends[k], points))
    return found

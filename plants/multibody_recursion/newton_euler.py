"""Forces of a tree by Newton and Euler: down the tree go the motions of its frames, up the forces that they take.

Where the node of a beam is reached, the forces on its sections' shifts and turns act on its coordinates: Q += T^T Q_s.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.casadi_functions import entries
from pliant.plants.multibody_parts.spatial import Motion, Wrench
from pliant.plants.validity.slender import Pull

from .layout import BASE
from .walk import Edge, Walk


def motions(walk: Walk, gravity: ca.SX, a: ca.SX | None = None) -> list[Motion]:
    """Of every node's frame, the base still, at accelerations `a` of the coordinates (None: zero)."""
    base, found = Motion(ca.SX.zeros(3), ca.SX.zeros(3), -gravity), list[Motion]()
    for node, edge in zip(walk.tree.nodes, walk.edges, strict=True):
        motion = base if node.parent == BASE else found[node.parent]
        given = {} if a is None else _given(walk, node.parent, edge, a)
        for step in edge.steps:
            motion = step.down(motion)
            if given:
                motion = step.pushed(motion, given)
        found.append(motion)
    return found


def _given(walk: Walk, parent: int, edge: Edge, a: ca.SX) -> dict[int, ca.SX]:
    """Accelerations by key of an edge's coordinates, its section's too."""
    found = {key: a[key] for key in walk.joint_keys}
    if edge.section is not None:
        at = walk.beam_keys.get(parent, range(0))
        pushed = edge.section.T @ entries(a, slice(at.start, at.stop))
        found |= {key: pushed[i] for i, key in enumerate(edge.keys)}
    return found


def reaction(walk: Walk, moves: list[Motion], a: ca.SX, external: dict[int, Wrench]) -> Wrench:
    """What the tree does to its base, in the base's axes about its origin, where its frames make those moves. Of a base
    that moves, its own inertia and what is fixed to it is not in it.
    """
    loads, _ = _loads(walk, moves, external)
    total = Wrench(ca.SX.zeros(3), ca.SX.zeros(3))
    for k in reversed(range(len(loads))):
        node, load = walk.tree.nodes[k], loads[k]
        if node.beam is not None and node.beam.n:
            for key, one in zip(walk.beam_keys[k], node.beam.coupling(walk.bent(k)[0]), strict=True):
                load = load + Wrench(a[key] * one.f, a[key] * one.n)
        for step in reversed(walk.edges[k].steps):
            load = step.up(load)
        if node.parent == walk.tree.root:
            total = Wrench(total.f - load.f, total.n - load.n)
        if node.parent != BASE:
            loads[node.parent] = loads[node.parent] + load
    return total


def forces(walk: Walk, gravity: ca.SX, external: dict[int, Wrench]) -> ca.SX:
    """What inertia, weight and `external` wrenches (on nodes) leave to be balanced at zero accelerations, by
    coordinates; strain apart.
    """
    loads, Q = _loads(walk, motions(walk, gravity), external)
    return _taken(walk, loads, Q)


def pulls(walk: Walk, gravity: ca.SX, external: dict[int, Wrench]) -> dict[int, Pull]:
    """The axial forces of every beam at zero accelerations, by node: what hangs on it counts as at its end."""
    moves, found = motions(walk, gravity), dict[int, Pull]()
    loads, _ = _loads(walk, moves, external)
    carried = _nothing(walk)
    for k in reversed(range(len(loads))):
        node, w = walk.tree.nodes[k], moves[k].omega
        if node.beam is not None:
            found[k] = Pull(-moves[k].a[0], w[1] ** 2 + w[2] ** 2, -carried[k].f[0])
        load = loads[k] + carried[k]
        for step in reversed(walk.edges[k].steps):
            load = step.up(load)
        if node.parent != BASE:
            carried[node.parent] = carried[node.parent] + load
    return found


def _loads(walk: Walk, moves: list[Motion], external: dict[int, Wrench]) -> tuple[list[Wrench], dict[int, ca.SX]]:
    """(what each node takes, what its beam's coordinates take) at zero accelerations, less the external wrenches."""
    nodes, loads, Q = walk.tree.nodes, _nothing(walk), dict[int, ca.SX]()
    for k, (node, motion) in enumerate(zip(nodes, moves, strict=True)):
        if node.inertia is not None:
            U = motion.U
            loads[k] = node.inertia.inertial(motion, U)
            if node.beam is not None:
                load, within = node.beam.inertial(motion, U, *walk.bent(k))
                loads[k] = loads[k] + load
                Q |= {key: within[i] for i, key in enumerate(walk.beam_keys.get(k, ()))}
        if k in external:
            loads[k] = Wrench(loads[k].f - external[k].f, loads[k].n - external[k].n)
    return loads, Q


def work(walk: Walk, external: dict[int, Wrench]) -> ca.SX:
    """Generalised forces of wrenches on nodes."""
    loads = [external.get(k, load) for k, load in enumerate(_nothing(walk))]
    return _taken(walk, loads, {})


def _nothing(walk: Walk) -> list[Wrench]:
    return [Wrench(ca.SX.zeros(3), ca.SX.zeros(3)) for _ in walk.tree.nodes]


def _taken(walk: Walk, loads: list[Wrench], Q: dict[int, ca.SX]) -> ca.SX:
    """Generalised forces of loads on the nodes, each about its frame's origin in its axes, added to Q."""
    loads, nodes = list(loads), walk.tree.nodes
    for k in reversed(range(len(nodes))):
        (steps, section, keys), load, parent = walk.edges[k], loads[k], nodes[k].parent
        for step in reversed(steps):
            for key, work in step.work(load).items():
                Q[key] = Q.get(key, ca.SX(0)) + work
            load = step.up(load)
        if section is not None:
            for i, key in enumerate(walk.beam_keys.get(parent, ())):
                Q[key] = Q.get(key, ca.SX(0)) + sum(
                    (section.T[r, i] * Q[s] for r, s in enumerate(keys) if s in Q and section.T[r, i].nnz()),
                    ca.SX(0),
                )
        if parent != BASE:
            loads[parent] = loads[parent] + load
    return ca.vertcat(*[Q.get(i, ca.SX(0)) for i in range(walk.v.shape[0])])

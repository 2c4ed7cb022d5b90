"""The mass matrix of a tree by composite bodies: up the tree go the inertia of all that hangs beyond a step, and what
unit accelerations of the coordinates beyond take of it.

Where the node of a beam is reached, its sections' shifts and turns give way to its coordinates: M += T^T M_s T.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.elastic_bodies.elastic_body import ElasticBody
from pliant.plants.multibody_parts.spatial import Inertia, Wrench

from .layout import BASE
from .walk import Walk

Matrix = dict[tuple[int, int], ca.SX]  # by pairs of coordinates, the larger first


def mass_matrix(walk: Walk) -> ca.SX:
    """M (n, n), sparse where the tree has no coupling."""
    n, found = walk.v.shape[0], _entries(walk)
    M = ca.SX(n, n)
    for (i, j), value in found.items():
        if i < n and not value.is_zero():
            M[i, j] = M[j, i] = value
    return M


def _entries(walk: Walk) -> Matrix:
    """M, of the recursion's own coordinates too."""
    nodes = walk.tree.nodes
    bodies = [node.inertia for node in nodes]
    columns: list[dict[int, Wrench]] = [{} for _ in nodes]
    M: Matrix = {}
    for k in reversed(range(len(nodes))):
        own = bodies[k]
        if own is None:
            continue
        beam = nodes[k].beam
        if beam is not None:
            own = own + _bent(walk, k, beam, columns[k], M)
        beyond, parent = columns[k], nodes[k].parent
        for step in reversed(walk.edges[k].steps):
            for other, wrench in beyond.items():
                for key, work in step.work(wrench).items():
                    add_to(M, key, other, work)
            units = step.unit(own)
            for key, load in units.items():
                for other, work in step.work(load).items():
                    if other <= key:
                        add_to(M, key, other, work)
            own = step.lift(own)
            beyond = {key: step.up(load) for key, load in (beyond | units).items()}
        if parent != BASE:
            above = bodies[parent]
            assert above is not None
            bodies[parent] = above + own
            columns[parent] |= beyond
    return M


def _bent(walk: Walk, k: int, beam: ElasticBody, beyond: dict[int, Wrench], M: Matrix) -> Inertia:
    """A beam's own inertia; in `beyond` and M its coordinates take the place of its sections'."""
    eta, _ = walk.bent(k)
    if not beam.n:
        return beam.inertia(eta)
    keys, coupled = walk.beam_keys[k], beam.coupling(eta)
    T, sections = at_sections(walk, k, beam.n, beyond)
    for other in [key for key in beyond if key not in sections]:
        for i, key in enumerate(keys):
            add_to(M, key, other, sum((T[r, i] * of_pair(M, s, other) for r, s in enumerate(sections)), ca.SX(0)))
    between = ca.SX.zeros(len(sections), len(sections))
    for r, s in enumerate(sections):
        for c, o in enumerate(sections):
            between[r, c] = of_pair(M, s, o)
    mass = beam.mass(eta) + T.T @ between @ T
    for i, a in enumerate(keys):
        for j, b in enumerate(keys[: i + 1]):
            add_to(M, a, b, mass[i, j])
    for i, key in enumerate(keys):
        load = coupled[i]
        for r, s in enumerate(sections):
            load = load + Wrench(T[r, i] * beyond[s].f, T[r, i] * beyond[s].n)
        beyond[key] = load
    for s in sections:
        del beyond[s]
    return beam.inertia(eta)


def at_sections(walk: Walk, k: int, n: int, beyond: dict[int, Wrench]) -> tuple[ca.SX, list[int]]:
    """(T (m, n), keys (m,)) of the sections of node k's beam from which bodies hang."""
    T, found = ca.SX(0, n), list[int]()
    for node, edge in zip(walk.tree.nodes, walk.edges, strict=True):
        if node.parent == k and edge.section is not None:
            used = [i for i, key in enumerate(edge.keys) if key in beyond]
            found += [edge.keys[i] for i in used]
            T = ca.vertcat(T, edge.section.T[used, :])
    return T, found


def of_pair(M: Matrix, a: int, b: int) -> ca.SX:
    return M.get((max(a, b), min(a, b)), ca.SX(0))


def add_to(M: Matrix, a: int, b: int, value: ca.SX) -> None:
    at = (max(a, b), min(a, b))
    M[at] = M.get(at, ca.SX(0)) + value

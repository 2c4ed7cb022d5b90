"""Which shapes of a tree's beams a motion of it needs: a family at a time, as many as move its outputs.

A family is bending in one of a beam's planes, its torsion or its stretch. With the shapes of one beyond the n-th held
at zero, joints and all else as they were, the outputs move by e(n); as many are kept as bring e(n) within a share of
what is asked. What they do to the motion itself is left out: a rung that is found so is still to be played.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.trajectory import Trajectory
from pliant.plants.elastic_bodies.of_body import coordinates_of

if TYPE_CHECKING:
    from .fidelity import TreeFidelity

Array = np.ndarray
SHARE = 0.1  # of what the outputs may be off: what the shapes that one family leaves out may do
SAMPLES = 60  # of the motion


def needed(tree: TreeFidelity, motion: Trajectory, compared: Sequence[str], within: float) -> TreeFidelity:
    """The tree with as many shapes of each family as the outputs `compared` of its own motion need to be within."""
    at = np.unique(np.linspace(0, len(motion.t) - 1, SAMPLES).round().astype(int))
    t, x, u = motion.t[at], motion.x[at], motion.u[at]
    names, wanted = [s.name for s in tree.states], [s.name for s in tree.outputs]
    columns = [wanted.index(name) for name in compared if name in wanted]
    whole = tree.measure(x, u, t=t)[:, columns]
    bodies = list(tree.bodies)
    for k, body in enumerate(bodies):
        counts, first = list(tree.counts(body)), 0
        if body.beam is None or not sum(counts):
            continue
        own = [names.index(f"{body.name}_{s.name}") for s in coordinates_of(body, tuple(counts))]
        own = [[i, names.index(tree.rates[names[i]])] for i in own]
        for family, most in enumerate(tuple(counts)):
            shapes = own[first : first + most]
            first += most
            while counts[family]:
                cut = x.copy()
                cut[:, np.ravel(shapes[counts[family] - 1 :])] = 0.0
                if np.abs(tree.measure(cut, u, t=t)[:, columns] - whole).max(initial=0.0) > SHARE * within:
                    break
                counts[family] -= 1
        bodies[k] = dataclasses.replace(body, modes=tuple(counts))
    return dataclasses.replace(tree, bodies=tuple(bodies))

"""What physics gives on a scene's motion, and how well that is known: what every fidelity is measured against.

`plant.physics()` is the richest model of the scene's machine. Its outputs are found from the cheapest variant's motion
by `CorrectedMotion`, first with few nodes and shapes, then with more of each until they are known to a small part of
the tolerance. Three errors are told, each by what one refinement still changed:

    passes   what Newton's method still moves
    time     nodes: half the parts of a period change a method of order four by 15 times what the finer ones err by
    shapes   one shape more a body

Where the correction does not settle, physics is simulated, and the result says so.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.signals import index
from pliant.studies.common.reference_motions import Motions

from .motion_nodes import MotionNodes
from .quasi_linear import CorrectedMotion, NotSettled

Array = np.ndarray
KNOWN = 0.02  # of the tolerance: to what each of the three errors is brought
RICHARDSON = 15.0  # 2^4 - 1
MOST_PARTS = 16  # of a control period
MOST_SHAPES = 6  # more than physics has by itself
LEFT_OUT = 0.5  # of what the last shapes that are known of do: a uniform beam's modes move its tip by (2 k - 1)^-5 each
RTOL = 1e-8  # of the cheap motion, and of physics where it is simulated


@dataclass(frozen=True, eq=False)
class PhysicsMotion:
    """The compared outputs (nt, n) at the control times, and their error by cause [their unit]."""

    outputs: Array
    physics: Plant
    passes: float
    time: float
    shapes: float
    how: str  # in words
    outside: str = ""  # which of its own ranges it leaves
    motion: CorrectedMotion | None = field(default=None, repr=False)  # None where it was simulated

    @property
    def uncertainty(self) -> float:
        """The sum of the errors told; what `physics.unmodelled` names is no part of it."""
        return self.passes + self.time + self.shapes


def physics_motion(motions: Motions, tolerance: float) -> PhysicsMotion:
    """Of the scene's open-loop motion, known to some percent of `tolerance`, or as well as the limits here allow.

    PliantError where neither the correction settles nor physics can be simulated.
    """
    if tolerance not in motions.truth:
        try:
            motions.truth[tolerance] = _Search(motions, tolerance).corrected()
        except (NotSettled, PliantError) as reason:
            motions.truth[tolerance] = _simulated(motions, tolerance, str(reason))
    found: PhysicsMotion = motions.truth[tolerance]
    return found


class _Search:
    """More nodes, then more shapes."""

    def __init__(self, motions: Motions, tolerance: float) -> None:
        self.motions, self.scene, self.within = motions, motions.scene, KNOWN * tolerance
        self.simple = motions.ladder[0]
        self._nodes: dict[int, tuple[MotionNodes, Any]] = {}

    def corrected(self) -> PhysicsMotion:
        parts, more = 1, 0
        coarse, _ = self._outputs(more, parts)
        while True:
            parts *= 2
            fine, passes = self._outputs(more, parts)
            time = _largest(fine - coarse) / RICHARDSON
            if time <= self.within or parts >= MOST_PARTS:
                break
            coarse = fine
        if time > 5 * self.within:
            raise NotSettled(f"{parts} parts of a control period leave an error of {time:.3g}")
        if RICHARDSON * time <= self.within:
            parts, fine, time = parts // 2, coarse, RICHARDSON * time
        found, last = fine, None
        while more < MOST_SHAPES:
            physics = self.scene.plant.physics(more + 1)
            if physics == self.scene.plant.physics(more):
                return self._found(found, passes, time, LEFT_OUT * (last or 0.0))  # no more are known of
            richer, passes = self._outputs(more + 1, parts)
            shapes, found, more = _largest(richer - found), richer, more + 1
            if shapes <= self.within or (last is not None and shapes > last):
                break
            last = shapes
        return self._found(found, passes, time, shapes)

    def _found(self, outputs: Array, passes: float, time: float, shapes: float) -> PhysicsMotion:
        motion = self.motion
        how = f"{motion.fine.label}, from the motion of {self.simple.label}"
        return PhysicsMotion(outputs, motion.fine, passes, time, shapes, how, motion.judged(), motion)

    def _outputs(self, more: int, parts: int) -> tuple[Array, float]:
        """The outputs with `more` shapes, and what Newton's method leaves."""
        if parts not in self._nodes:
            nodes = MotionNodes(self.scene.times, self.motions.held, parts)
            tight = {"rtol": RTOL, "atol": RTOL / 100}
            self._nodes[parts] = nodes, self.motions.at_nodes(self.simple, nodes.inputs, nodes.all, **tight)
        physics = self.scene.plant.physics(more)
        self.motion = corrected(self.motions, physics, self.simple, *self._nodes[parts])
        left = self.motion.settle(self.within)
        return self.motion.outputs, left


def corrected(motions: Motions, fine: Plant, simple: Plant, nodes: MotionNodes, motion: Trajectory) -> CorrectedMotion:
    """The motion of `fine` from that of `simple` at the nodes, before the first pass."""
    columns = [index(fine.outputs, name, "output") for name in motions.scene.compare]
    return CorrectedMotion(fine, simple, motion, nodes, motions.start(fine), columns)


def outputs_of(motions: Motions, plant: Plant, like: PhysicsMotion) -> Array:
    """The compared outputs (nt, n) of another fine plant, found as `like` was."""
    if like.motion is None:
        return motions.outputs(plant, RTOL)
    nodes, simple = like.motion.nodes, motions.ladder[0]
    tight = {"rtol": RTOL, "atol": RTOL / 100}
    found = corrected(motions, plant, simple, nodes, motions.at_nodes(simple, nodes.inputs, nodes.all, **tight))
    found.settle(max(like.uncertainty, RTOL))
    return found.outputs


def _largest(difference: Array) -> float:
    return float(np.abs(difference).max())


def _simulated(motions: Motions, tolerance: float, reason: str) -> PhysicsMotion:
    """By simulation, shape by shape."""
    plant, within = motions.scene.plant, KNOWN * tolerance
    found, shapes = motions.outputs(plant.physics(), RTOL), 0.0
    for more in range(1, MOST_SHAPES + 1):
        if plant.physics(more) == plant.physics(more - 1):
            break
        richer = motions.outputs(plant.physics(more), RTOL)
        shapes, found = _largest(richer - found), richer
        if shapes <= within:
            break
    physics = plant.physics(more)
    how = f"{physics.label}, simulated: {reason}"
    return PhysicsMotion(found, physics, 0.0, within, shapes, how, motions.outside_so_far(physics))

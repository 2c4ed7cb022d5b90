"""What physics gives on a scene's motion, and how well that is known: what every fidelity of the scene is measured against.

`plant.physics()` is the richest model of the scene's machine. Its outputs are found from the cheapest variant's motion by
`CorrectedMotion`, first with few nodes and shapes, then with more of each until they are known to a small part of the
tolerance. Three errors are told, each by what one refinement still changed:

    passes   what Newton's method still moves
    time     nodes: half the parts of a period change a method of order four by 15 times what the finer ones err by
    shapes   one shape more a body

Where the correction does not settle, physics is simulated, and the result says so.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError
from pliant.plants.core.signals import index
from pliant.studies.common.reference_motions import Motions

from .motion_nodes import MotionNodes
from .quasi_linear import CorrectedMotion, NotSettled

Array = np.ndarray
KNOWN = 0.02  # of the tolerance: to what each of the three errors is brought
RICHARDSON = 15.0  # 2^4 - 1
MOST_PARTS = 16  # of a control period
MOST_SHAPES = 6  # more than physics has by itself
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

    @property
    def uncertainty(self) -> float:
        """The sum of the errors told; what `physics.unmodelled` names is no part of it."""
        return self.passes + self.time + self.shapes


def physics_motion(motions: Motions, tolerance: float) -> PhysicsMotion:
    """Of the scene's open-loop motion, known to some percent of `tolerance`, or as well as the limits here allow.

    PliantError where neither the correction settles nor physics can be simulated.
    """
    try:
        return _Search(motions, tolerance).corrected()
    except (NotSettled, PliantError) as reason:
        return _simulated(motions, tolerance, str(reason))


class _Search:
    """More nodes, then more shapes."""

    def __init__(self, motions: Motions, tolerance: float) -> None:
        self.corrected_motion: CorrectedMotion
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
                return PhysicsMotion(found, physics, passes, time, 0.0, self._words(physics))
            richer, passes = self._outputs(more + 1, parts)
            shapes, found, more = _largest(richer - found), richer, more + 1
            if shapes <= self.within or (last is not None and shapes > last):
                break
            last = shapes
        return PhysicsMotion(found, physics, passes, time, shapes, self._words(physics))

    def _words(self, physics: Plant) -> str:
        return f"{physics.label}, from the motion of {self.simple.label}"

    def _outputs(self, more: int, parts: int) -> tuple[Array, float]:
        """The outputs with `more` shapes, and what Newton's method leaves."""
        physics = self.scene.plant.physics(more)
        if parts not in self._nodes:
            nodes = MotionNodes(self.scene.times, self.motions.held, parts)
            self._nodes[parts] = nodes, self.motions.at_nodes(self.simple, nodes.inputs, nodes.all, rtol=RTOL, atol=RTOL / 100)
        nodes, motion = self._nodes[parts]
        columns = [index(physics.outputs, name, "output") for name in self.scene.compare]
        start = self.motions.start(physics)
        corrected = CorrectedMotion(physics, self.simple, motion, nodes, start, columns)
        left = corrected.settle(self.within)
        return corrected.outputs, left


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
    return PhysicsMotion(found, physics, 0.0, 1e-2 * within, shapes, f"{physics.label}, simulated: {reason}")

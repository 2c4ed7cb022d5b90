"""What physics gives on a scene's motion, and how well that is known: what every fidelity is measured against.

`plant.physics()` is the richest model of the scene's machine. Its outputs are found from the cheapest variant's motion
by `CorrectedMotion`, first with few nodes and shapes, then with more of each until they are known to a small part of
the tolerance. Three errors are told, each by what one refinement still changed:

    passes   what Newton's method still moves
    time     nodes: twice the parts of a period change a method of order four by 15 times what they still err by; a
             fifth of the change is told
    shapes   one shape more a body; where with one more the mass matrix is lost, the last that there is

Where the correction does not settle, physics is simulated, and the result says so; its error in time is then what a
tolerance ten times as wide changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pliant.plants import MassMatrixError, Plant, PliantError, Trajectory
from pliant.plants.core.signals import index
from pliant.plants.motions.time_limit import TooLong, time_limit
from pliant.plants.validity.ranges import in_words, left
from pliant.plants.validity.rotating_sections import NONE_HOLDS
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions

from .fine_model import between_control_times, start_of
from .motion_nodes import MotionNodes
from .quasi_linear import CorrectedMotion, NotSettled

Array = np.ndarray
KNOWN = 0.03  # of the tolerance: to what each of the three errors is brought, and ..
ROUNDING = 1e-7  # .. of the outputs themselves: no better is asked
ROUGH = 5.0  # times that: physics is simulated where nodes leave more
GAINS = 5.0  # what twice the parts change over what they err by; 15 of order four, less while modes are coarse
EASILY = 100.0  # times better than asked: half as many parts do as well
MOST_PARTS = 16  # of a control period
MOST_SHAPES = 6  # more than physics has by itself
FEWER = 3  # than that: where its mass matrix is lost
RTOL = 1e-8  # of the cheap motion, and of physics where it is simulated ..
SHARE = 0.05  # of an estimated effect: to what it is known
SLIGHT = 0.02  # of the tolerance: an effect that is estimated to be less is not found truly
NEARBY = 2  # parts of a control period at which it is, where physics was simulated
ROUGHLY = 1e-6  # of the motion by which its ranges are judged
PATIENCE, COME = 10.0, 0.1  # [s] of processor time after which a simulation must have come so far, of 1
SIMULATED = 60.0  # [s] of processor time that simulations with more and more shapes may take
LOOSER = 10.0  # .. times that: the motion by which its error in time is told


@dataclass(frozen=True, eq=False)
class PhysicsMotion:
    """The compared outputs (nt, n) at the control times, and their error by cause [their unit]."""

    outputs: Array
    physics: Plant
    passes: float
    time: float
    shapes: float
    how: str  # in words
    estimated: dict[str, float] = field(default_factory=dict)  # {effect that it leaves out: about what it is worth}
    left: tuple[dict[str, Any], ...] = ()  # its own ranges that it leaves, each as in Trajectory.stats["validity"]
    motion: CorrectedMotion | None = field(default=None, repr=False)  # None where it was simulated

    @property
    def uncertainty(self) -> float:
        """The sum of the errors told, and of what is estimated of effects that it leaves out; what `physics.unmodelled`
        names beside is no part of it.
        """
        return self.passes + self.time + self.shapes + sum(self.estimated.values())

    @property
    def outside(self) -> str:
        """Ranges that it leaves beyond which other kinematics would hold, in words: it is then no physics."""
        return "; ".join(in_words(entry) for entry in self.left if entry["holds"] != NONE_HOLDS)

    @property
    def beyond(self) -> tuple[str, ...]:
        """Those beyond which no kinematics of this library hold, in words: materials that are no longer linear."""
        return tuple(in_words(entry) for entry in self.left if entry["holds"] == NONE_HOLDS)


def physics_motion(motions: Motions, tolerance: float) -> PhysicsMotion:
    """Of the scene's open-loop motion, known to some percent of `tolerance`, or as well as the limits here allow.

    PliantError where neither the correction settles nor physics can be simulated.
    """
    if tolerance not in motions.truth:
        try:
            motions.truth[tolerance] = _found(motions, tolerance)
        except PliantError as failure:  # sought no second time
            motions.truth[tolerance] = failure
    found: PhysicsMotion | PliantError = motions.truth[tolerance]
    if isinstance(found, PliantError):
        raise found
    return found


def _found(motions: Motions, tolerance: float) -> PhysicsMotion:
    """With fewer shapes than physics has by itself where its mass matrix is lost with as many: their slopes are steeper
    than second-order shortening bears, where those of fewer are not.
    """
    reason = ""
    for less in range(FEWER + 1):
        if less and motions.scene.plant.physics(-less) == motions.scene.plant.physics(1 - less):
            break
        try:
            return _Search(motions, tolerance, -less).corrected()
        except MassMatrixError as lost:
            reason = reason or str(lost)
        except PliantError as unsettled:
            reason = reason or str(unsettled)
            if not less:
                break
    return _simulated(motions, tolerance, reason)


class _Search:
    """More nodes, then more shapes; each motion begins where the last one ended."""

    def __init__(self, motions: Motions, tolerance: float, first: int = 0) -> None:
        self.first = first
        self.motions, self.scene = motions, motions.scene
        self.simple = motions.ladder[0]
        self.tolerance, self.within = tolerance, KNOWN * tolerance
        self.motion: CorrectedMotion | None = None

    def corrected(self) -> PhysicsMotion:
        more, lost = self.first, ""
        coarse, _ = self._outputs(more, 1)
        self.within = max(self.within, ROUNDING * _largest(coarse))
        found, passes, parts, time = self._in_time(more, coarse, 1)
        physics, shapes, last = self.scene.plant.physics, 0.0, float("inf")
        if EASILY * time <= self.within:
            parts //= 2  # twice as many have shown that these do
        while more < MOST_SHAPES and physics(more + 1) != physics(more):
            before = self.motion
            try:
                richer, passes = self._outputs(more + 1, parts)
            except PliantError as failure:
                if not isinstance(failure, MassMatrixError) and "exact rotations" in physics(more).effects:
                    raise  # a simulation may go on
                self.motion, lost = before, f"; not with a shape more: {failure}"
                if more == self.first:
                    shapes = _largest(found - self._poorer())
                break
            shapes, found, more = _largest(richer - found), richer, more + 1
            if shapes <= self.within or shapes > last:
                break
            last = shapes
        if physics(more + 1) == physics(more):  # no more are known of
            shapes *= physics(more).left_out
        if more > self.first:  # the shapes that were added are the fastest
            found, passes, parts, time = self._in_time(more, found, parts)
        if time > ROUGH * self.within:
            raise NotSettled(f"{parts} parts of a control period leave an error of {time:.3g}")
        motion = self.motion
        assert motion is not None
        how = f"{motion.fine.label}, from the motion of {self.simple.label}{lost}"
        known = PhysicsMotion(found, motion.fine, passes, time, shapes, how, motion=motion)
        return _judged(self.motions, self.tolerance, known, motion.trajectory())

    def _poorer(self) -> Array:
        """The outputs with a shape fewer: what the last shape did bounds, as a rule, what those beyond do."""
        plant, motion = self.scene.plant.physics(self.first - 1), self.motion
        if plant == self.scene.plant.physics(self.first):
            raise NotSettled("its mass matrix is lost with a shape more, and it has none fewer")
        assert motion is not None
        simple = from_simple(self.motions, plant, motion.nodes)
        simple.settle(self.within)
        return simple.outputs

    def _in_time(self, more: int, coarse: Array, parts: int) -> tuple[Array, float, int, float]:
        """(outputs, what passes leave, parts, error) with so many parts of a period that the error is within."""
        while True:
            parts *= 2
            found, passes = self._outputs(more, parts)
            time = _largest(found - coarse) / GAINS
            if time <= self.within or parts >= MOST_PARTS:
                return found, passes, parts, time
            coarse = found

    def _outputs(self, more: int, parts: int) -> tuple[Array, float]:
        """The outputs with `more` shapes, and what Newton's method leaves."""
        fine = self.scene.plant.physics(more)
        nodes = MotionNodes(self.scene.times, self.motions.held, parts)
        if self.motion is None:
            self.motion = from_simple(self.motions, fine, nodes)
        else:
            self.motion = self.motion.refined(fine, nodes, start_of(self.motions, fine), compared(self.motions, fine))
        left = self.motion.settle(self.within)
        return self.motion.outputs, left


def compared(motions: Motions, plant: Plant) -> list[int]:
    """Where the compared outputs stand in [y; x]."""
    return [index((*plant.outputs, *plant.states), name, "output or state") for name in motions.scene.compare]


def from_simple(motions: Motions, fine: Plant, nodes: MotionNodes) -> CorrectedMotion:
    """The motion of `fine` from that of the cheapest variant, before the first pass."""
    simple = motions.ladder[0]
    motion = between_control_times(simple, motions.run(simple, rtol=RTOL, atol=RTOL / 100), nodes)
    if motion is None:
        motion = motions.at_nodes(simple, nodes.inputs, nodes.all, rtol=RTOL, atol=RTOL / 100)
    return CorrectedMotion.from_simple(fine, simple, motion, nodes, start_of(motions, fine), compared(motions, fine))


def _largest(difference: Array) -> float:
    return float(np.abs(difference).max())


def outputs_of(motions: Motions, plant: Plant, like: PhysicsMotion, share: float) -> Array:
    """The compared outputs (nt, n) of another fine plant near to a physics that was corrected, as well known or to a
    share of how far they are from it.
    """
    motion = like.motion
    if motion is None:
        raise NotSettled("physics was simulated")
    found = motion.refined(plant, motion.nodes, start_of(motions, plant), compared(motions, plant))
    found.step()
    found.settle(
        max(like.uncertainty, ROUNDING * _largest(like.outputs), share * _largest(found.outputs - like.outputs))
    )
    return found.outputs


def _with_effect(motions: Motions, plant: Plant, known: PhysicsMotion) -> Array:
    """The compared outputs (nt, n) of a plant that moves nearly as physics does."""
    try:
        if known.motion is not None:
            return outputs_of(motions, plant, known, SHARE)
        nodes = MotionNodes(motions.scene.times, motions.held, NEARBY)
        own = motions.at_nodes(known.physics, nodes.inputs, nodes.all, rtol=ROUGHLY, atol=ROUGHLY / 100)
        columns = compared(motions, plant)
        near = CorrectedMotion.from_simple(plant, known.physics, own, nodes, start_of(motions, plant), columns)
        near.settle(KNOWN * _largest(near.outputs - known.outputs))
        return near.outputs
    except NotSettled:
        return motions.outputs(plant, ROUGHLY)


def _judged(motions: Motions, tolerance: float, known: PhysicsMotion, motion: Trajectory) -> PhysicsMotion:
    """With what the motion tells of effects that physics leaves out, and the ranges that it leaves."""
    estimated = {}
    for name, plants in known.physics.estimates(motion).items():
        for plant in plants:
            estimated[name] = _largest(_with_effect(motions, plant, known) - known.outputs)
            if estimated[name] <= SLIGHT * tolerance:
                break
    ranges = tuple(found.to_json() for found in left(known.physics, motion))
    return replace(known, estimated=estimated, left=ranges)


def _patience(motions: Motions, reason: str) -> Callable[[float], None]:
    """Ends a motion that has come no way after PATIENCE: it would take minutes."""
    began, first, last = processor_time(), motions.scene.times[0], motions.scene.times[-1]

    def reached(t: float) -> None:
        spent, way = processor_time() - began, (t - first) / (last - first)
        if spent > PATIENCE and way < COME:
            raise PliantError(
                f"Newton's method does not settle ({reason}), and to simulate {motions.scene.plant.physics().label} "
                f"takes too long: {spent:.0f} s of processor time for the first {t - first:.3g} s"
            )

    return reached


def _simulated(motions: Motions, tolerance: float, reason: str) -> PhysicsMotion:
    """By simulation, shape by shape. PliantError where its first motion would take minutes."""
    with time_limit(SIMULATED):
        found, shapes, more = _shape_by_shape(motions, tolerance, reason)
    physics = motions.scene.plant.physics(more)
    time = max(_largest(motions.outputs(physics, LOOSER * RTOL) - found), ROUNDING * _largest(found))
    known = PhysicsMotion(found, physics, 0.0, time, shapes, f"{physics.label}, simulated: {reason}")
    return _judged(motions, tolerance, known, motions.run(physics, rtol=ROUGHLY, atol=ROUGHLY / 100))


def _shape_by_shape(motions: Motions, tolerance: float, reason: str) -> tuple[Array, float, int]:
    """(outputs, what the last shape changed, shapes more than physics has), as many as change them, or time allows."""
    plant, more = motions.scene.plant, 0
    found, shapes = motions.outputs(plant.physics(), RTOL, progress=_patience(motions, reason)), 0.0
    for more in range(1, MOST_SHAPES + 1):
        if plant.physics(more) == plant.physics(more - 1):
            break
        try:
            richer = motions.outputs(plant.physics(more), RTOL)
        except (MassMatrixError, TooLong):
            if more == 1:
                raise  # what its shapes leave out is not known
            return found, shapes, more - 1
        shapes, found = _largest(richer - found), richer
        if shapes <= max(KNOWN * tolerance, ROUNDING * _largest(found)):
            break
    return found, shapes, more

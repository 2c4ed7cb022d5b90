"""What physics gives on a scene's motion, and how well that is known: what every fidelity is measured against.

`plant.physics()` is the richest model of the scene's machine. Its outputs are found from the cheapest variant's motion
by `Search`, first with few nodes and shapes, then with more of each until they are known to a small part of the
tolerance. Three errors are told, each by what one refinement still changed:

    passes   what Newton's method still moves
    time     nodes: twice the parts of a period change a method of order four by 15 times what they still err by; a
             fifth of the change is told
    shapes   one shape more a body; where with one more the mass matrix is lost, the last that there is

Where the correction does not settle, physics is simulated, and the result says so; its error in time is then what a
tolerance ten times as wide changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pliant.plants import MassMatrixError, Plant, PliantError, Trajectory
from pliant.plants.motions.time_limit import TooLong, time_limit
from pliant.plants.validity.ranges import left
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions

from .fine_model import compared, start_of
from .known_physics import KNOWN, ROUNDING, PhysicsMotion, largest
from .motion_nodes import MotionNodes
from .node_search import MOST_SHAPES, RTOL, Search
from .quasi_linear import CorrectedMotion, NotSettled

Array = np.ndarray
FEWER = 3  # shapes than physics has by itself: where its mass matrix is lost
SHARE = 0.05  # of an estimated effect: to what it is known
SLIGHT = 0.02  # of the tolerance: an effect that is estimated to be less is not found truly
NEARBY = 2  # parts of a control period at which it is, where physics was simulated
ROUGHLY = 1e-6  # of the motion by which its ranges are judged
PATIENCE, COME = 10.0, 0.1  # [s] of processor time after which a simulation must have come so far, of 1
SIMULATED = 60.0  # [s] of processor time that simulations with more and more shapes may take
LOOSER = 10.0  # times the tolerance of a simulation: the motion by which its error in time is told


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
            known, motion = Search(motions, tolerance, -less).corrected()
            return _judged(motions, tolerance, known, motion.trajectory())
        except MassMatrixError as lost:
            reason = reason or str(lost)
        except PliantError as unsettled:
            reason = reason or str(unsettled)
            if not less:
                break
    return _simulated(motions, tolerance, reason)


def outputs_of(motions: Motions, plant: Plant, like: PhysicsMotion, share: float) -> Array:
    """The compared outputs (nt, n) of another fine plant near to a physics that was corrected, as well known or to a
    share of how far they are from it.
    """
    motion = like.motion
    if motion is None:
        raise NotSettled("physics was simulated")
    found = motion.refined(plant, motion.nodes, start_of(motions, plant), compared(motions, plant))
    found.step()
    found.settle(max(like.uncertainty, ROUNDING * largest(like.outputs), share * largest(found.outputs - like.outputs)))
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
        near.settle(KNOWN * largest(near.outputs - known.outputs))
        return near.outputs
    except NotSettled:
        return motions.outputs(plant, ROUGHLY)


def _judged(motions: Motions, tolerance: float, known: PhysicsMotion, motion: Trajectory) -> PhysicsMotion:
    """With what the motion tells of effects that physics leaves out, and the ranges that it leaves."""
    estimated = {}
    for name, plants in known.physics.estimates(motion).items():
        for plant in plants:
            estimated[name] = largest(_with_effect(motions, plant, known) - known.outputs)
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
    time = max(largest(motions.outputs(physics, LOOSER * RTOL) - found), ROUNDING * largest(found))
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
        shapes, found = largest(richer - found), richer
        if shapes <= max(KNOWN * tolerance, ROUNDING * largest(found)):
            break
    return found, shapes, more

"""Which method and step plays a chosen plant fastest within a tolerance, and the largest fixed step that keeps it.

Each method is tried from its coarsest setting on, as `simulate` plays it, until one keeps the tolerance against physics
with what is known of that; none is tried that is expected to take longer than the fastest found, ten times over, as
small steps on the virtual machine do once compiled ones hold. The method for stiff plants is tried where dop853's
loosest tolerance holds: what bounds its steps is then their stability.
"""

from __future__ import annotations

from dataclasses import replace
from statistics import median
from typing import Any

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.plants.integration.batch_stepper import compile_motions, motion_kernel
from pliant.plants.integration.step_maps import METHODS
from pliant.plants.motions.compile_rule import STEPPING
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions, in_time
from pliant.studies.physics.known_physics import PhysicsMotion

from .speed_accuracy import SUBSTEPS, TOLERANCES, Row, comparable_seconds
from .stepper_runs import motion, outputs_of, seconds_a_period, stepper

FIXED = ("rk4", "rk8", "rosenbrock")
ADAPTIVE = ("dop853", "rodas5p")
STIFF = "rodas5p"
IMPLICIT = ("rosenbrock", "rodas5p")  # what is tried of plants that are stiff
COMPILING = 5.0  # [s] that compiling it is worth
RUNS = 3  # a setting that holds is timed so often
WORTH = 2.0  # [s]: where compiling takes less, timings are of compiled code
LONG = 0.05  # [s]: a run that takes longer is timed once
LARGE = 8_000  # operations of the rates past which none is sought on the virtual machine
IN_ALL = 10.0  # [s] of processor time that runs on the virtual machine may take
PATIENCE = 10.0  # times the fastest: longer runs are not made


def integrators(
    motions: Motions, truth: PhysicsMotion, plant: Plant, tolerance: float
) -> tuple[Row | None, Row | None]:
    """(the fastest row within the tolerance, the fixed-step row with the largest step within it); None where none is,
    and of a large plant that is not compiled.
    """
    compiled, until = compile_motions(plant, WORTH), processor_time() + IN_ALL
    if not compiled and plant._dynamics.function.n_instructions() > LARGE:
        return None, None  # seconds for each run, and more for its stability limit
    progress = None if compiled else in_time(plant, until)
    duration = motions.scene.steps * motions.scene.dt
    best: Row | None = None
    largest: Row | None = None
    bounded_by_stability = False
    for method in (*FIXED, *ADAPTIVE):
        if plant.stiff and method not in IMPLICIT:
            continue
        worth_it = plant.stiff or (bounded_by_stability and compile_motions(plant, COMPILING, STIFF))
        if (method == STIFF and not worth_it) or (progress is not None and processor_time() > until):
            continue
        for options in _settings(method, motions.scene.dt):
            row = Row(plant.label, plant.nx, method, options.get("step"), options.get("rtol"))
            if _in_vain(motions, plant, row, best, largest):
                break
            loosest = options.get("rtol") == TOLERANCES["dop853"][0]
            try:
                run = motions.run(plant, method=method, progress=progress, **options)
            except PliantError:
                continue
            error = float(np.abs(motions.compared(run) - truth.outputs).max())
            if not error + truth.uncertainty <= tolerance:
                if best is not None and run.stats["seconds"] > PATIENCE * (best.seconds or 0.0) * duration:
                    break
                continue
            bounded_by_stability |= method == "dop853" and loosest
            more = RUNS - 1 if run.stats["seconds"] < LONG else 0
            runs = [run, *(motions.run(plant, method=method, **options) for _ in range(more))]
            times = comparable_seconds(runs)
            row = replace(row, seconds=median(times) / duration, error=error, runs=len(times))
            if best is None or (row.seconds or 0.0) < (best.seconds or 0.0):
                best = row
            if row.step is not None and (largest is None or row.step > (largest.step or 0.0)):
                largest = row
            break
    return best, largest


def _in_vain(motions: Motions, plant: Plant, row: Row, best: Row | None, largest: Row | None) -> bool:
    """Whether a fixed step is no larger than one that holds, and takes far longer than the fastest setting."""
    if best is None or largest is None or row.step is None or row.step > (largest.step or 0.0):
        return False
    duration = motions.scene.steps * motions.scene.dt
    steps = round(duration / row.step)
    return _least_seconds(plant, row.method, steps) > PATIENCE * (best.seconds or 0.0) * duration


def _least_seconds(plant: Plant, method: str, steps: int) -> float:
    """What the virtual machine takes for so many fixed steps [s], at least: of each its evaluations of the rates, of a
    linearly implicit one three and no Jacobian. 0 where compiled motions are at hand.
    """
    kernel, tableau = motion_kernel(plant, method), METHODS[method].tableau
    if kernel is None or kernel.at_hand:
        return 0.0
    start, each = STEPPING
    evaluations = len(tableau.b) if tableau else 3
    return steps * (start + each * evaluations * int(plant._dynamics._function.n_instructions()))


def in_lanes(motions: Motions, truth: PhysicsMotion, plant: Plant, tolerance: float, lanes: int) -> Row | None:
    """The fastest row within the tolerance by the stepper, so many lanes at once in one thread."""
    scene, start, best = motions.scene, motions.start(plant), None
    for method in IMPLICIT[:1] if plant.stiff else FIXED:
        for k in SUBSTEPS:
            row = Row(plant.label, plant.nx, method, scene.dt / k, None, path="stepper", lanes=lanes)
            try:
                states, _ = motion(
                    stepper(plant, method, scene.dt, scene.dt / k, 1, "double"), start, motions.held, scene.times
                )
            except PliantError:
                continue
            error = float(np.abs(outputs_of(motions, plant, states) - truth.outputs).max())
            if not error + truth.uncertainty <= tolerance:
                continue
            step = stepper(plant, method, scene.dt, scene.dt / k, lanes, "double")
            each, runs = seconds_a_period(step, start, motions.held, scene.times)
            row = replace(row, seconds=each / (scene.dt * lanes), error=error, runs=runs, native=step.native)
            if best is None or (row.seconds or 0.0) < (best.seconds or 0.0):
                best = row
            break
    return best


def _settings(method: str, dt: float) -> list[dict[str, Any]]:
    """From coarse to fine."""
    if method in ADAPTIVE:
        return [{"rtol": rtol, "atol": rtol / 100} for rtol in TOLERANCES[method]]
    return [{"step": dt / k} for k in SUBSTEPS]

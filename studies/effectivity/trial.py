"""One random scene: what `choose` says of it, what is true, and what each cost."""

from __future__ import annotations

import resource
import time

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.studies.common.atomic_files import plain
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.choice import Choice, choose

from .finer_models import Truth, truth
from .random_scenes import Drawn, random_scene
from .tally import Row

PLAYED = 1e-9  # rtol of a rung's motion, where its true error is told
TIMED = 1e-6  # rtol at which runs are timed
LONG, MOST = 0.1, 3  # [s] and runs
SHAPES = 8  # more than physics has by itself: where the physics that `choose` ended with is looked for


def trial(seed: int) -> Row:
    """The row of one seed, as JSON knows it; what is not finite is None. A crash of `choose`, and a truth that cannot
    be found, are rows that say so.

    seed, kind, tolerance; truth and its uncertainty; met, chosen, bound, true (error of the chosen one), convergence,
    physics, missing; rungs: (variant, predicted, bound, true) of each that was tried; wall and cpu [s] of choose, cpu
    of one run of the chosen model and of the finest; failure: what ended it, in words.
    """
    found: Row = plain(_trial(seed))
    return found


def _trial(seed: int) -> Row:
    row: Row = {"seed": seed, "failure": ""}
    try:
        drawn = random_scene(seed)
        row |= {"kind": drawn.kind, "plant": drawn.scene.plant.label, "tolerance": drawn.scene.tolerance}
        wall, cpu = time.perf_counter(), _cpu()
        found = choose(drawn.scene)
        row |= {"wall": time.perf_counter() - wall, "cpu": _cpu() - cpu, **_said(found)}
    except Exception as failure:  # whatever it is: the campaign counts crashes
        return row | {"failure": f"{type(failure).__name__}: {failure}"}
    motions = Motions(drawn.scene)
    try:
        known = truth(drawn, motions)
    except PliantError as failure:
        return row | {"truth": "", "uncertainty": None, "why": f"{type(failure).__name__}: {failure}"}
    row |= {"truth": known.model, "uncertainty": known.uncertainty}
    return row | _compared(drawn, found, motions, known)


def _said(found: Choice) -> Row:
    bound = next((r.bound for r in found.rungs if r.chosen), None)
    return {
        "met": found.met,
        "chosen": found.plant.label,
        "bound": bound,
        "convergence": found.convergence,
        "physics": found.physics,
        "missing": list(found.missing),
        "outside": next((r.outside for r in found.rungs if r.chosen), ""),
    }


def _compared(drawn: Drawn, found: Choice, motions: Motions, known: Truth) -> Row:
    plants = _by_label(drawn.scene.plant)
    rungs, own = [], None
    for rung in found.rungs:
        if rung.error is None:
            continue
        error = _error(motions, plants[rung.variant], known)
        rungs.append({"variant": rung.variant, "predicted": rung.error, "bound": rung.bound, "true": error})
        if rung.chosen:
            own = error
    chosen, finest = (_timed(motions, p) for p in (found.plant, plants[found.rungs[-1].variant]))
    return {"true": own, "rungs": rungs, "cpu_chosen": chosen, "cpu_finest": finest}


def _by_label(plant: Plant) -> dict[str, Plant]:
    """Every rung that `choose` may have stood on."""
    ladder = (*plant.ladder(), plant, *(plant.physics(more) for more in range(SHAPES)))
    return {p.label: p for p in reversed(ladder)}


def _error(motions: Motions, plant: Plant, known: Truth) -> float:
    """Infinite where its motion fails."""
    try:
        return float(np.abs(motions.outputs(plant, PLAYED) - known.outputs).max())
    except PliantError:
        return float("inf")


def _timed(motions: Motions, plant: Plant) -> float | None:
    """CPU [s] of one run, kernels warm: of as many as take `LONG` together, at most `MOST`."""
    try:
        motions.run(plant, rtol=TIMED, atol=TIMED / 100)
        began, runs = _cpu(), 0
        while runs < MOST and _cpu() - began < LONG:
            motions.run(plant, rtol=TIMED, atol=TIMED / 100)
            runs += 1
        return (_cpu() - began) / runs
    except PliantError:
        return None


def _cpu() -> float:
    """Of this process and of the compilers that it waited for [s]."""
    spent = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(r.ru_utime + r.ru_stime for r in spent)

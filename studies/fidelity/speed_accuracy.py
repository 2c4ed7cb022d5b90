"""Speed against accuracy: every fidelity of a scene's plant, by every integrator, at several steps.

Error  the largest difference of the scene's compared outputs from the reference, over the scene's open-loop
       motion [the outputs' unit]; the reference is physics, see `physics_motion`, with its own uncertainty
Time   wall time of the integration per simulated second, the median of several runs after a warm-up
"""

from __future__ import annotations

import dataclasses
import json
import math
import time as clock
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.argument_gates import (
    require_all,
    require_flag,
    require_function,
    require_instance,
    require_names,
    require_number,
    require_path,
    require_seconds,
    require_text,
)
from pliant.plants.files.atomic_files import Together, write_text
from pliant.plants.integration.batch_stepper import compile_motions
from pliant.studies.common import machine
from pliant.studies.common.formatting import duration
from pliant.studies.common.reference_motions import Motions, Progress, silent

from .physics_motion import physics_motion

SUBSTEPS = (1, 2, 5, 10, 20, 50)  # fixed steps a control period
TOLERANCES = {"dop853": (1e-3, 1e-5, 1e-7, 1e-9), "rodas5p": (1e-3, 1e-5, 1e-7), "cvodes": (1e-4, 1e-6, 1e-8)}
METHODS = ("dop853", "rk4", "rk8", "rodas5p", "rosenbrock", "midpoint", "cvodes")
ROOTS = {"rodas5p": 5}  # the root of a tolerance by which steps become shorter; else the eighth
COMPILED = ("rk4", "rodas5p")  # which stands for all explicit methods, and what has a library of its own
ENOUGH = 0.1  # a smaller step is not tried once its error is below this share of the variant's own error ..
FLOOR = 1e-3  # .. or below this share of the tolerance
SLOW = 2.0  # [s] a run expected to take longer is not made
RUNS_AWAY = 1e5  # times the tolerance: a variant that goes so far from the reference is not timed
SPENT = "not run: the time budget was spent"


def comparable_seconds(runs: Sequence[Trajectory]) -> list[float]:
    """Seconds of the runs made as the last was: the virtual machine's, before it paid to compile, do not count."""
    native = runs[-1].stats.get("native")
    return [run.stats["seconds"] for run in runs if run.stats.get("native") == native]


@dataclass(frozen=True)
class Row:
    """One variant by one method at one step. `failure` says why there are no numbers."""

    variant: str
    states: int
    method: str
    step: float | None  # [s], fixed-step methods
    rtol: float | None  # adaptive methods
    seconds: float | None = None  # wall time per simulated second
    error: float | None = None  # against the reference
    step_error: float | None = None  # against the same variant, converged: what the integrator alone does
    runs: int = 0  # timed runs
    failure: str | None = None
    pareto: bool = False

    @property
    def setting(self) -> str:
        """Like "rk4, 2 ms" or "dop853, rtol 1e-05"."""
        at = duration(self.step) if self.step is not None else f"rtol {self.rtol:.0e}"
        return f"{self.method}, {at}"


@dataclass(frozen=True)
class Reference:
    """What errors are measured against, and what is shown of its own error."""

    variant: str  # physics
    how: str  # it was found
    uncertainty: float  # [unit of the compared outputs]


@dataclass(frozen=True)
class Chart:
    """The measured rows; `reference` and `machine` say against what and on what."""

    scene: str
    compare: tuple[str, ...]
    tolerance: float
    duration: float  # [s] simulated
    rows: tuple[Row, ...]
    reference: Reference
    machine: dict[str, str]
    budget: float  # [s]
    unit: str = "m"  # of the compared outputs, errors and tolerance
    outside: tuple[tuple[str, str], ...] = ()  # variants whose own motion leaves their range, and which

    @property
    def measured(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.failure is None)

    @property
    def failed(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.failure is not None)

    def fastest(self, tolerance: float | None = None, variant: str | None = None) -> Row | None:
        """The fastest row within the tolerance (None: the scene's), of one variant if named."""
        bound = self.tolerance if tolerance is None else require_number("fastest.tolerance", tolerance, "nonnegative")
        if variant is not None:
            require_text("fastest.variant", variant)
        rows = [r for r in self.measured if (r.error or 0.0) <= bound and variant in (None, r.variant)]
        return min(rows, key=lambda r: r.seconds or 0.0, default=None)

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @property
    def not_run(self) -> int:
        """Settings that the budget left no time for."""
        return sum(row.failure == SPENT for row in self.rows)

    def save(self, table: str | Path, together: Together | None = None) -> None:
        """Write the table as json; the picture is drawn by `figures.speed_accuracy.save`, in one with the table
        where both are told the same `together`. OSError, which names the file."""
        table, text = require_path("Chart.save: table", table), json.dumps(self.to_json(), indent=1) + "\n"
        if together is None:
            write_text(table, text)
        else:
            together.text(table, text)


def pareto(points: Sequence[tuple[float, float]]) -> list[bool]:
    """Which of the points (error, time) no other point beats in one and equals or beats in the other."""

    def beaten(e: float, s: float) -> bool:
        return any(a <= e and b <= s and (a, b) != (e, s) for a, b in points)

    return [not beaten(e, s) for e, s in points]


def chart(
    scene: Scene,
    *,
    budget: float = 15.0,
    variants: Sequence[Plant] | None = None,
    methods: Sequence[str] = METHODS,
    prune: bool = True,
    motions: Motions | None = None,
    progress: Progress | None = None,
) -> Chart:
    """Measure the rows of a scene within `budget` [s]; coarse settings of all variants come before fine ones, one
    method before the next, and variants that can keep the scene's tolerance before those that cannot.

    Physics is found, and motions are compiled where that takes less than the budget, before it begins; each variant has
    one row at least.

    `variants` (None: the plant's ladder) are charted; errors are against the finest of the ladder.
    A setting is not run when the time is spent, when it would take too long, or when a measured row is faster
    and better than its variant can be at any step (`prune`); its row says so. A setting finer than one whose
    error no longer matters has no row. ValueError for a budget that is not positive or an unknown method.
    """
    require_instance("chart.scene", scene, Scene)
    budget = require_seconds("chart.budget", budget)
    methods = require_names("chart.methods", methods, METHODS, "method")
    if not methods:
        raise ValueError(f"chart.methods = () must name at least one of {', '.join(METHODS)}")
    if variants is not None and not (variants := require_all("chart.variants", variants, Plant)):
        raise ValueError("chart.variants = () must hold at least one Plant")
    prune = require_flag("chart.prune", prune)
    if motions is not None:
        require_instance("chart.motions", motions, Motions)
    if progress is not None:
        require_function("chart.progress", progress)
    told, motions = progress or silent, motions or Motions(scene)
    told(0.0, "physics")
    truth = physics_motion(motions, scene.tolerance)
    reference = Reference(truth.physics.label, truth.how, truth.uncertainty)
    plants = tuple(variants) if variants is not None else motions.ladder
    for i, plant in enumerate(plants):
        told(0.2 * i / len(plants), f"{plant.label}, compiled")
        for method in COMPILED:
            if method in methods:
                compile_motions(plant, budget, method)
    began = clock.perf_counter()
    runner = Runner(motions, truth.outputs, began + budget, prune)
    rows: list[Row] = []
    useful_first = sorted(plants, key=lambda plant: motions.difference(plant, truth.outputs) > scene.tolerance)
    for level in range(len(SUBSTEPS)):
        for method in methods:
            for plant in useful_first:
                done = (clock.perf_counter() - began) / budget
                told(0.2 + 0.8 * min(done, (level + 1) / len(SUBSTEPS)), f"{plant.label}, {method}")
                row = runner.measure(plant, method, level)
                if row is not None:
                    rows.append(row)
    order = {plant.label: i for i, plant in enumerate(plants)}
    rows.sort(key=lambda r: (order[r.variant], METHODS.index(r.method), -(r.step or r.rtol or 0.0)))
    good = [i for i, row in enumerate(rows) if row.failure is None]
    front = pareto([(rows[i].error or 0.0, rows[i].seconds or 0.0) for i in good])
    for i, keep in zip(good, front):
        rows[i] = dataclasses.replace(rows[i], pareto=keep)
    told(1.0, "chart")
    return Chart(
        scene=scene.name,
        compare=scene.compare,
        tolerance=scene.tolerance,
        duration=scene.steps * scene.dt,
        rows=tuple(rows),
        reference=reference,
        machine=machine.describe(),
        budget=budget,
        unit=scene.unit,
        outside=tuple((p.label, words) for p in plants if (words := motions.outside_so_far(p))),
    )


class Runner:
    """Runs one setting after another; remembers what is built, what is enough and how long things take."""

    def __init__(self, motions: Motions, exact: np.ndarray, deadline: float, prune: bool) -> None:
        self.motions, self.exact, self.deadline, self.prune = motions, exact, deadline, prune
        self.duration = motions.scene.steps * motions.scene.dt
        self.built: set[tuple[Plant, str]] = set()
        self.enough: set[tuple[Plant, str]] = set()
        self.last: dict[tuple[Plant, str], tuple[float, float]] = {}  # work units, seconds
        self.done: list[Row] = []

    def measure(self, plant: Plant, method: str, level: int) -> Row | None:
        """The row of a setting, or None where there is nothing to gain by it."""
        key = plant, method
        if key in self.enough or level >= len(TOLERANCES.get(method, SUBSTEPS)):
            return None
        options: dict[str, Any]
        if method in TOLERANCES:
            rtol = TOLERANCES[method][level]
            row = Row(plant.label, plant.nx, method, None, rtol)
            options, work = {"rtol": rtol, "atol": rtol / 100}, rtol ** (-1 / ROOTS.get(method, 8))
        else:
            step = self.motions.scene.dt / SUBSTEPS[level]
            row = Row(plant.label, plant.nx, method, step, None)
            options, work = {"step": step}, 1 / step
        expected = self.last[key][1] * work / self.last[key][0] if key in self.last else 0.0
        why = self._refusal(plant, expected)
        if why:
            return dataclasses.replace(row, failure=why)
        try:
            row = self._timed(row, plant, work, {"method": method, **options})
        except PliantError as failure:
            return dataclasses.replace(row, failure=f"{type(failure).__name__}: {failure}")
        self.done.append(row)
        return row

    def _refusal(self, plant: Plant, expected: float) -> str:
        """Why a setting expected to take this long [s] is not run; empty where it is."""
        away = self.motions.difference(plant, self.exact)
        if RUNS_AWAY * self.motions.scene.tolerance < away < math.inf:
            return f"not run: runs away, {away:.2g} {self.motions.scene.unit} from the reference"
        if self.prune and expected > 0:
            best = self.motions.difference(plant, self.exact)
            for row in self.done:
                assert row.error is not None and row.seconds is not None
                if row.error <= best and row.seconds * self.duration <= expected:
                    return f"not run: dominated by {row.variant}, {row.setting}"
        if expected > SLOW:
            return f"too slow: about {expected:.2g} s a run, limit {SLOW:g} s"
        begun = any(row.variant == plant.label for row in self.done)  # a variant has one row at least
        if begun and clock.perf_counter() + expected > self.deadline:
            return SPENT
        return ""

    def _timed(self, row: Row, plant: Plant, work: float, options: dict[str, Any]) -> Row:
        motions, key = self.motions, (plant, row.method)
        own, exact = motions.converged(plant), self.exact
        motion = motions.run(plant, **options)
        runs = [motion] if key in self.built else []
        self.built.add(key)
        while len(runs) < (3 if sum(m.stats["seconds"] for m in runs) < 0.15 else 1):
            runs.append(motions.run(plant, **options))
        times = comparable_seconds(runs)
        seconds = median(times)
        self.last[key] = work, seconds
        found = motions.compared(motion)
        error, step_error = float(np.abs(found - exact).max()), float(np.abs(found - own).max())
        own_error = float(np.abs(own - exact).max())
        if step_error < max(ENOUGH * own_error, FLOOR * motions.scene.tolerance):
            self.enough.add(key)
        return dataclasses.replace(
            row, seconds=seconds / self.duration, error=error, step_error=step_error, runs=len(times)
        )

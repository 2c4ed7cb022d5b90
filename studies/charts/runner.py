"""Runs one setting after another; remembers what is enough, what failed and how long things take."""

from __future__ import annotations

import dataclasses
import math
import time as clock
from collections.abc import Sequence
from statistics import median
from typing import Any

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.plants.integration.batch_stepper import compile_motions
from pliant.plants.motions.time_limit import TooLong, time_limit
from pliant.plants.native import kernel_loader
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.speed_accuracy import ROOTS, RUNS_AWAY, SPENT, Row, comparable_seconds
from pliant.studies.fidelity.stepper_runs import motion, outputs_of, repeats, seconds_a_period, stepper

from .linear_runs import linear_run, simplifies
from .plan import IMPLICIT

ENOUGH = 0.1  # a smaller step is not tried once its error is below this share of the variant's own error ..
FLOOR = 1e-3  # .. or below this share of the tolerance
SLOW = 2.0  # [s] a run expected to take longer is not made, and one that takes longer given up at its deadline
SHORT = 0.1  # [s] runs are repeated where they take less
COMPILES = {"rk4": 1.5e-4, "rk8": 2e-4}  # [s] for each operation of the rates: what a kernel that is new may take ..
LONGER = 1.7e-3  # .. and one of a method that needs Jacobians


class Runner:
    """Rows of one chart, each measured once."""

    def __init__(self, motions: Motions, exact: np.ndarray, prune: bool) -> None:
        self.motions, self.exact, self.prune = motions, exact, prune
        self.duration = motions.scene.steps * motions.scene.dt
        self.rows: dict[tuple[Any, ...], Row] = {}
        self.built: set[tuple[Any, ...]] = set()
        self.enough: set[tuple[str, str]] = set()  # variant, method
        self.last: dict[tuple[Any, ...], tuple[float, float]] = {}  # work units, seconds

    @property
    def done(self) -> list[Row]:
        """The measured ones."""
        return [row for row in self.rows.values() if row.failure is None]

    def take(self, plant: Plant, row: Row) -> None:
        """A row that was measured before, or now."""
        self.rows[row.key] = row
        if row.failure is not None or row.path == "linear":
            return
        assert row.seconds is not None and row.step_error is not None
        self.last[_cost(row)] = _work(row), row.seconds * self.duration
        if row.path == "simulate":
            own_error = self.motions.difference(plant, self.exact)
            if row.step_error < max(ENOUGH * own_error, FLOOR * self.motions.scene.tolerance):
                self.enough.add((row.variant, row.method))

    def measure(self, plant: Plant, row: Row, deadline: float) -> Row | None:
        """The row of a setting, or None where there is nothing to gain by it, or it is there already."""
        if row.key in self.rows or self._no_use(plant, row):
            return None
        why, began = self._refusal(plant, row, deadline), processor_time()
        if why:
            found = dataclasses.replace(row, failure=why)
        else:
            if row.path == "simulate" and row.method in IMPLICIT and _cost(row) not in self.built:
                compile_motions(plant, deadline - processor_time(), row.method)
            try:
                made = {"simulate": self._simulated, "stepper": self._stepped, "linear": self._linear}[row.path]
                with time_limit(max(deadline - began, SLOW)):
                    timed = made(plant, row)
                if timed is None:
                    return None
                found = timed
            except TooLong as late:
                spent = processor_time() - began
                told = f"too slow: given up after {spent:.2g} s, {late}" if spent >= SLOW else SPENT
                found = dataclasses.replace(row, failure=told)
            except PliantError as failure:
                text = str(failure)
                told = text if text.startswith("no linear model") else f"{type(failure).__name__}: {text}"
                found = dataclasses.replace(row, failure=told)
        if found.failure != SPENT:
            self.take(plant, found)
        return found

    def beaten(self, row: Row) -> int:
        """How many rows of `simulate` are as good as its row of the same step, and faster: few promise much."""
        twin = self.rows.get(_twin(row).key)
        if row.path != "stepper" or twin is None or twin.failure is not None:
            return 0 if row.path != "stepper" else len(self.rows)
        at = (twin.error or 0.0, twin.seconds or 0.0)
        return sum((r.error or 0.0) <= at[0] and (r.seconds or 0.0) < at[1] for r in self.done if r.path == "simulate")

    def _no_use(self, plant: Plant, row: Row) -> bool:
        """A step that is finer than need be, or that `simulate` was not, or could not be, played by."""
        if row.path == "simulate":
            return (row.variant, row.method) in self.enough
        if row.path == "linear":
            return not simplifies(self.motions, plant, row.method)
        twin = self.rows.get(_twin(row).key)
        if twin is None:  # fine enough already, or not played yet
            return (row.variant, row.method) in self.enough
        return twin.failure is not None and not twin.failure.startswith(("not run: dominated", "too slow"))

    def _refusal(self, plant: Plant, row: Row, deadline: float) -> str:
        """Why a setting is not run; empty where it is."""
        away, unit = self.motions.difference(plant, self.exact), self.motions.scene.unit
        if row.path != "linear" and RUNS_AWAY * self.motions.scene.tolerance < away < math.inf:
            return f"not run: runs away, {away:.2g} {unit} from the reference"
        expected = self._expected(row)
        if self.prune and expected > 0:
            for other in self.done:
                assert other.error is not None and other.seconds is not None
                better = other.lanes == row.lanes and other.path != "linear" and other.error <= away
                if better and other.seconds * self.duration <= expected:
                    return f"not run: dominated by {other.variant}, {other.setting}"
        if expected > SLOW and row.lanes == 1:
            return f"too slow: about {expected:.2g} s a run, limit {SLOW:g} s"
        if row.path == "stepper" and _kernel(row) not in self.built and kernel_loader.wanted():
            expected += COMPILES.get(row.method, LONGER) * plant._dynamics.function.n_instructions()
        return SPENT if processor_time() + expected > deadline else ""

    def _expected(self, row: Row) -> float:
        """Seconds of a run, a lane, as the last one of its kind tells; 0 where none does."""
        work, seconds = self.last.get(_cost(row), (1.0, 0.0))
        return seconds * _work(row) / work

    def _simulated(self, plant: Plant, row: Row) -> Row:
        options: dict[str, Any] = {"method": row.method, "step": row.step}
        if row.rtol is not None:
            options |= {"rtol": row.rtol, "atol": row.rtol / 100}
        run = self.motions.run(plant, **options)
        runs = [run] if _cost(row) in self.built else []
        self.built.add(_cost(row))
        while not runs or (runs[-1].stats["seconds"] < SHORT and len(runs) < repeats(runs[-1].stats["seconds"])):
            runs.append(self.motions.run(plant, **options))
        times = comparable_seconds(runs)
        return self._told(plant, row, self.motions.compared(run), times, native=bool(runs[-1].stats["native"]))

    def _stepped(self, plant: Plant, row: Row) -> Row | None:
        motions, scene = self.motions, self.motions.scene
        assert row.step is not None
        one = self.rows.get(dataclasses.replace(row, lanes=1).key)
        if row.lanes > 1 and (one is None or one.failure is not None):
            return None
        step = stepper(plant, row.method, scene.dt, row.step, row.lanes, row.precision)
        self.built.add(_kernel(row))
        if not step.native and row.precision == "single":
            return dataclasses.replace(row, failure="no compiled code: single precision is had in compiled code alone")
        start = motions.start(plant)
        if row.lanes > 1:  # each lane gives what one alone gives
            assert one is not None
            each, runs = seconds_a_period(step, start, motions.held, scene.times)
            seconds = each / (scene.dt * row.lanes)
            return dataclasses.replace(
                one, lanes=row.lanes, seconds=seconds, runs=runs, native=step.native, pareto=False
            )
        states, first = motion(step, start, motions.held, scene.times)
        times = [motion(step, start, motions.held, scene.times)[1] for _ in range(repeats(first))]
        outputs = outputs_of(motions, plant, states)
        return self._told(plant, row, outputs, times, native=step.native)

    def _linear(self, plant: Plant, row: Row) -> Row:
        run = linear_run(self.motions, plant, row.method, row.step)
        outputs, times = run.play(), list[float]()
        while not times or len(times) < repeats(times[-1]):
            began = clock.perf_counter()
            run.play()
            times.append(clock.perf_counter() - began)
        row = dataclasses.replace(row, states=run.states, made=run.made / self.duration, rms_bound=run.rms_bound)
        return self._told(plant, row, outputs, times, native=False)

    def _told(self, plant: Plant, row: Row, outputs: np.ndarray, times: Sequence[float], native: bool) -> Row:
        """The row with its numbers; outputs (nt, n)."""
        own = self.motions.converged(plant)
        return dataclasses.replace(
            row,
            seconds=median(times) / self.duration,
            error=_largest(outputs - self.exact),
            step_error=None if row.path == "linear" else _largest(outputs - own),
            runs=len(times),
            native=native,
        )


def _largest(difference: np.ndarray) -> float:
    """IntegrationError is raised before what is no number comes here."""
    return float(np.abs(difference).max())


def _work(row: Row) -> float:
    """What time is proportional to, about."""
    if row.step is not None:
        return 1 / row.step
    return 1.0 if row.rtol is None else row.rtol ** (-1 / ROOTS.get(row.method, 8))


def _cost(row: Row) -> tuple[Any, ...]:
    """Rows of one kind, whose times tell each other's."""
    return row.variant, row.path, row.method, row.lanes, row.precision


def _kernel(row: Row) -> tuple[Any, ...]:
    """Rows that run by one kernel."""
    return row.variant, "kernel", row.method, row.precision


def _twin(row: Row) -> Row:
    """The same step by `simulate`."""
    return dataclasses.replace(row, path="simulate", lanes=1, precision="double")

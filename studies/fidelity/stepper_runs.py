"""A scene's motion by the stepper: one call a control period, as a loop of a user's own makes it."""

from __future__ import annotations

import time as clock
import warnings
from statistics import median

import numpy as np

from pliant.plants import IntegrationError, Plant
from pliant.plants.core.errors import DivergenceWarning
from pliant.plants.integration.batch_stepper import Stepper
from pliant.plants.motions.time_limit import check_time
from pliant.plants.native.kernel_loader import NativeWarning
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.fine_model import compared

DTYPES = {"double": np.float64, "single": np.float32}
RUNS, MOST_RUNS = 3, 9
TIMED = 0.03  # [s] of runs, after which there are no more than the fewest
LONG = 0.02  # [s] of calls that are timed at once, at least, where the motion has as many


def stepper(plant: Plant, method: str, dt: float, step: float, lanes: int, precision: str) -> Stepper:
    """One thread; `dt` [s] a call, of as many steps as `step` [s] asks."""
    options = {"method": method, "batch": lanes, "dtype": DTYPES[precision], "substeps": round(dt / step), "threads": 1}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NativeWarning)  # `native` of the row tells it
        return plant.stepper(dt, **options)  # type: ignore[arg-type]


def motion(step: Stepper, start: np.ndarray, held: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, float]:
    """The states (nt, nx) of one lane and the seconds of all calls. IntegrationError where they are no numbers."""
    x = _lanes(step, start)
    found = np.empty((len(times), step.plant.nx))
    found[0] = start
    began = clock.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DivergenceWarning)
        for k in range(len(times) - 1):
            check_time(float(times[k]))
            step(x, held[k], t=float(times[k]), out=x)
            found[k + 1] = x[0]
    seconds = clock.perf_counter() - began
    good = np.isfinite(found).all(axis=1)
    if not good.all():
        k = int(np.argmin(good))
        why = f"the states of the stepper are no longer finite numbers at t = {times[k]:.4g} s"
        raise IntegrationError(why, float(times[k]), found[k], step.dt / step.substeps)
    return found, seconds


def outputs_of(motions: Motions, plant: Plant, states: np.ndarray) -> np.ndarray:
    """The compared outputs (nt, n) of the states (nt, nx) at the control times."""
    y = np.asarray(plant.measure(states, motions.held, t=motions.scene.times))
    return np.hstack([y, states])[:, compared(motions, plant)]


def seconds_a_period(step: Stepper, start: np.ndarray, held: np.ndarray, times: np.ndarray) -> tuple[float, int]:
    """(of one call for all lanes [s], median over the runs; runs), over as much of the motion as timing takes."""
    periods = 1
    while True:
        taken = _calls(step, start, held, times, periods)
        if taken >= LONG or periods == len(times) - 1:
            break
        periods = min(len(times) - 1, 4 * periods)
    return median(_calls(step, start, held, times, periods) for _ in range(RUNS)) / periods, RUNS


def repeats(seconds: float) -> int:
    """How many runs that take so long are timed."""
    return int(min(max(RUNS, TIMED / max(seconds, 1e-6)), MOST_RUNS))


def _calls(step: Stepper, start: np.ndarray, held: np.ndarray, times: np.ndarray, periods: int) -> float:
    x = _lanes(step, start)
    began = clock.perf_counter()
    for k in range(periods):
        check_time(float(times[k]))
        step(x, held[k], t=float(times[k]), out=x)
    return clock.perf_counter() - began


def _lanes(step: Stepper, start: np.ndarray) -> np.ndarray:
    """The start in every lane, in the layout that the kernel takes without a copy."""
    return np.asfortranarray(np.tile(start, (step.batch, 1)), dtype=step.kernel.dtype)

"""Drive a plant through time: inputs of any form, fixed or adaptive steps, failures with time, state and step."""

from __future__ import annotations

import time as clock
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_function, require_number, shown
from pliant.plants.core.parameters import require_choice, require_parts, require_seconds
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.signals import read_only_times
from pliant.plants.core.trajectory import Trajectory, of_run
from pliant.plants.motions import adaptive_steps, repeated_motions
from pliant.plants.motions.held_inputs import HeldInput, Input, sampling_grid
from pliant.plants.motions.observations import observer
from pliant.plants.motions.repeated_motions import StepLimit
from pliant.plants.rosenbrock.adaptive import METHOD as RODAS
from pliant.plants.validity.ranges import judged

from . import cvodes, radau
from .motion_run import FixedRun, MotionRun, PairRun, RosenbrockRun
from .step_maps import METHODS, ROUNDED, damped_within, doubtful


class StiffRun(MotionRun):
    """radau, in one go under a smooth input, and cvodes, interval by interval."""

    def prepare(self) -> None:
        self.first: float | None = None

    def on_the_virtual_machine(self, z: np.ndarray) -> None:
        k, held, law = self.reached, self.drive.samples[self.reached], self.drive.law
        end = self.next_part() if self.method == "radau" else k + 1
        fixed, tolerances = (self.w, self.p), (self.rtol, self.atol)
        if self.method == "cvodes":
            if law is not None:
                raise ValueError('method = "cvodes" needs an input held between times: give an array, not a callable')
            z[end] = cvodes.advance(self.plant, self.t[k], self.t[end], z[k], held, *fixed, *tolerances)
        else:
            self.first = self.first_step(k, z[k]) if self.first is None else self.first
            first, function = min(self.first, self.t[end] - self.t[k]), None if law is None else self.drive
            options = {"rtol": self.rtol, "atol": self.atol, "first": first}
            with np.errstate(all="ignore"):
                z[k : end + 1], tried = radau.march(
                    self.plant, self.t[k : end + 1], z[k], held, function, *fixed, **options
                )
            self.steps += tried
        self.reached = end
        if self.progress is not None:
            self.progress(self.t[end])


ADAPTIVE: dict[str, type[MotionRun]] = {"dop853": PairRun, RODAS: RosenbrockRun, "radau": StiffRun, "cvodes": StiffRun}


def simulate(
    plant: PlantLike,
    x0: Any,
    u: Input,
    t: Any,
    *,
    w: Any,
    p: Any,
    method: str,
    step: float | None,
    rtol: float,
    atol: float,
    audit: bool,
    progress: Any,
) -> Trajectory:
    """See Plant.simulate."""
    if step is not None and audit is False and progress is None:
        short = repeated_motions.again(plant, x0, u, t, w, p, method, step, (rtol, atol))
        if short is not None:
            return short[0] if short[1] is None else judged(plant, short[0], p, reached=short[1], stacklevel=3)
    t = read_only_times("t", t)
    require_choice("simulate", "method", method, (*ADAPTIVE, *METHODS))
    if (step is not None) != (method in METHODS):
        known = ", ".join(METHODS)
        raise ValueError(f"step = {shown(step)} must be a number of seconds for {known}, and None otherwise")
    if step is not None:
        step = require_seconds("step", step)
        require_parts("step", step, float(t[-1] - t[0]), adaptive_steps.MOST_STEPS, "steps")
    for name, value in (("rtol", rtol), ("atol", atol)):
        require_number(name, value, "positive", most=1.0)
    if progress is not None:
        require_function("simulate.progress", progress)
    if (audit := require_flag("simulate.audit", audit)) and not (hasattr(plant, "net_power") and method == "dop853"):
        raise ValueError(f'audit = True needs a plant with energies and method "dop853", not {method!r}')
    (_, x, _, w, p), batch = plant._arguments(plant.rest_state if x0 is None else x0, np.zeros(plant.nu), w, p)
    if batch is not None:
        raise ValueError(f"simulate takes one state ({plant.nx},), not a batch of {batch}")
    plant.check_state(x)
    w, p = (np.ascontiguousarray(a, dtype=float) for a in (w, p))

    began = clock.perf_counter()
    grid, rows = sampling_grid(t, u)
    drive = HeldInput(plant, u, grid, w, p)
    run = ADAPTIVE.get(method, FixedRun)(plant, drive, grid, x, w, p, method, step, rtol, atol, audit, progress)
    states, work, samples = (z[rows] for z in (*run.march(), drive.samples))
    values = t[:, None], states, samples, w, p
    rates, outputs, reached = observer(plant)(values, len(t))
    stats: dict[str, Any] = {
        "method": method,
        "seconds": clock.perf_counter() - began,
        "steps": run.steps,
        "step": step,
        "native": 0 < run.native == run.steps,
    }
    if audit:
        energy = plant.energy(states, p=p)  # type: ignore[attr-defined]
        largest = np.abs(energy).max() or 1.0
        stats["energy_balance"] = float(np.abs(energy - energy[0] - work).max() / largest)
    made = of_run(
        t=t,
        x=states,
        u=samples,
        y=outputs[0],
        **plant.signals,
        dx=plant._told_rates(values, rates),
        w=np.tile(w, (len(t), 1)),
        hold="linear" if drive.smooth else "zero-order",
        stats=stats,
    )
    if stats["native"] and step is not None and isinstance(run, FixedRun) and drive.controller is drive.law is None:
        limit = StepLimit(run.every, damped_within(method), ROUNDED, doubtful)
        repeated_motions.prepare(plant, t, method, step, run.library, run.counts, limit)
    return judged(plant, made, p, reached=reached, stacklevel=3)

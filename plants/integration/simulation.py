"""Drive a plant through time: inputs of any form, fixed or adaptive steps, failures with time, state and step."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_function, require_number, shown
from pliant.plants.core.errors import IntegrationError, StabilityLimitError
from pliant.plants.core.parameters import require_choice, require_parts, require_seconds
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.signals import read_only_times
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.motions.motion_library import A_CALL, LONG, TOO_MANY, MotionLibrary
from pliant.plants.motions.motion_source import PAIR
from pliant.plants.motions.observations import observer
from pliant.plants.validity.ranges import judged

from . import cvodes, dormand_prince, radau
from .batch_stepper import motion_kernel
from .held_inputs import HeldInput, Input, sampling_grid
from .step_guard import diverged
from .step_maps import METHODS, check_step, doubtful, stepper

ADAPTIVE = ("dop853", "radau")
TOLD = 200  # parts of a compiled motion after which progress is told, at most
CHECKS = 8  # how often along a fixed-step run the step limit is looked at again


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
    t = read_only_times("t", t)
    require_choice("simulate", "method", method, (*ADAPTIVE, "cvodes", *METHODS))
    if (step is not None) != (method in METHODS):
        known = ", ".join(METHODS)
        raise ValueError(f"step = {shown(step)} must be a number of seconds for {known}, and None otherwise")
    if step is not None:
        step = require_seconds("step", step)
        require_parts("step", step, float(t[-1] - t[0]), dormand_prince.MOST_STEPS, "steps")
    for name, value in (("rtol", rtol), ("atol", atol)):
        require_number(name, value, "positive", most=1.0)
    if progress is not None:
        require_function("simulate.progress", progress)
    if (audit := require_flag("simulate.audit", audit)) and not (hasattr(plant, "net_power") and method == "dop853"):
        raise ValueError(f'audit = True needs a plant with energies and method "dop853", not {method!r}')
    (_, x, _, w, p), batch = plant._arguments(plant.rest_state if x0 is None else x0, None, w, p)
    if batch is not None:
        raise ValueError(f"simulate takes one state ({plant.nx},), not a batch of {batch}")
    plant.check_state(x)
    w, p = (np.ascontiguousarray(a, dtype=float) for a in (w, p))

    began = clock.perf_counter()
    grid, rows = sampling_grid(t, u)
    drive = HeldInput(plant, u, grid, w, p)
    run = _Run(plant, drive, grid, x, w, p, method, step, rtol, atol, audit, progress)
    states, work, samples = (z[rows] for z in (*run.march(), drive.samples))
    values, rows_at = plant._arguments(states, samples, w, p, t)
    rates, outputs = observer(plant)(values, rows_at or 1)
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
    made = Trajectory(
        t=t,
        x=states,
        u=samples,
        y=outputs[0],
        states=plant.states,
        inputs=plant.inputs,
        outputs=plant.outputs,
        dx=plant.told_rates(values, rates),
        w=np.tile(w, (len(t), 1)),
        disturbances=plant.disturbances,
        hold="linear" if drive.smooth else "zero-order",
        stats=stats,
    )
    return judged(plant, made, p, stacklevel=3)


@dataclass
class _Run:
    """One simulation: the state at every time of t, interval by interval where the input is held."""

    plant: PlantLike
    drive: HeldInput
    t: np.ndarray
    x0: np.ndarray
    w: np.ndarray
    p: np.ndarray
    method: str
    step: float | None
    rtol: float
    atol: float
    audit: bool
    progress: Any

    def __post_init__(self) -> None:
        self.z0 = np.append(self.x0, 0.0) if self.audit else self.x0
        self.first: float | None = None
        self.steps = self.native = self.reached = 0  # steps, of them in compiled code; intervals that are done
        self.adaptive, self.intervals = self.method in ADAPTIVE, len(self.t) - 1
        self.every = max(1, self.intervals // CHECKS)
        if self.step is not None:
            self.counts = np.maximum(1, np.ceil(np.diff(self.t) / self.step * (1 - 1e-12))).astype(LONG)
            self.long = self.counts.sum() > A_CALL
        covered = self.method in METHODS or (self.method == "dop853" and self.drive.law is None and not self.audit)
        name = PAIR if self.adaptive else self.method
        self.kernel = motion_kernel(self.plant, name) if covered else None
        tableau = METHODS[name].tableau if covered else None
        self.evaluations = len(tableau.b) if tableau else 1  # of a step
        self.library: MotionLibrary | None = None
        self.slow = 0.0  # [s] spent on the virtual machine

    def march(self) -> tuple[np.ndarray, np.ndarray]:
        """States (nt, nx) and net work (nt,) at all times."""
        nx = self.plant.nx
        z = np.empty((len(self.t), len(self.z0)))
        z[0] = self.z0
        self.plant.dynamics(z[0, :nx], w=self.w, p=self.p, t=self.t[0])  # raises where the start is singular
        try:
            while self.reached < self.intervals:
                self.drive.decide(self.reached, z[self.reached][:nx])
                self._look_for_library(z)
                if self.library is None:
                    self._on_the_virtual_machine(z)
                elif self.adaptive:
                    self._adaptive_natively(self.library, z)
                else:
                    self._fixed_natively(z)
            self.drive.decide(self.intervals, z[-1][:nx])
        except (IntegrationError, StabilityLimitError) as stopped:
            last = getattr(stopped, "state", z[self.reached])[:nx]
            self.plant.explain_stop(z[: self.reached + 1, :nx], last, self.w, self.p)
            raise
        return z[:, :nx], z[:, nx] if self.audit else np.zeros(len(self.t))

    def _look_for_library(self, z: np.ndarray) -> None:
        """Take the compiled motions where they are at hand or worth it: asked at the start, and of adaptive steps,
        whose number nobody knows before, again after 1, 2, 4, .. intervals.
        """
        k = self.reached
        if self.kernel is None or self.library is not None or k & (k - 1) or (k and not self.adaptive):
            return
        steps = self.intervals if self.adaptive else int(self.counts.sum())
        coming = self.kernel.seconds(steps, self.evaluations)
        self.library = self.kernel.library(max(coming, self.slow * (self.intervals - k) / k) if k else coming)
        if self.library is not None and not self.adaptive:
            given = (np.ascontiguousarray(self.t), self.counts, self.drive.samples)
            self.motion = self.library.stepped(self.method, given, (self.w, self.p, z))

    def _on_the_virtual_machine(self, z: np.ndarray) -> None:
        """One interval; under a smooth input as many again as are done, or all where no library is to be expected."""
        began, k, before = clock.perf_counter(), self.reached, self.steps
        if self.adaptive:
            all_at_once = self.drive.smooth and (self.kernel is None or self.kernel.settled)
            more = self.intervals - k if all_at_once else max(1, k if self.drive.smooth else 1)
            end = min(self.intervals, k + more)
            z[k : end + 1] = self._adaptive(self.t[k : end + 1], z[k], k)
        else:
            end = k + 1
            z[end] = self._cvodes(k, z[k]) if self.method == "cvodes" else self._fixed(k, z[k])
        self.reached = end
        if self.kernel is not None:  # what is built on the way is not what steps cost
            taken = self.kernel.seconds(self.steps - before, self.evaluations)
            self.slow += (taken := min(clock.perf_counter() - began, taken))
            self.kernel.spent += taken
        if self.progress is not None and self.method != "dop853":  # which reports by itself
            self.progress(self.t[end])

    def _ahead(self) -> int:
        """How far the input is known without asking a controller, in parts of which progress can be told."""
        if self.drive.controller is not None or self.drive.law is not None:
            return self.reached + 1
        part = self.intervals if self.progress is None else -(-self.intervals // TOLD)
        return min(self.intervals, self.reached + part)

    def _fixed_natively(self, z: np.ndarray) -> None:
        k, checked = self.reached, self.long
        if checked:  # beforehand, so that no long run is in vain
            self._check(k, z[k])
        if self.drive.law is None:
            done = self.motion.march(k, self._ahead())
        else:
            done = self.motion.march_sampled(k, METHODS[self.method].input_times, self.drive.at)
        self.reached, i = self.motion.place
        self._check_passed(k + checked, self.reached + (not done), z)
        taken = int(self.counts[k : self.reached].sum()) + i
        self.steps, self.native = self.steps + taken, self.native + taken
        if not done:  # the virtual machine has the last word, and the words
            j = self.reached
            z[j + 1] = self._fixed(j, z[j + 1 if i else j], start=i)
            self.reached += 1
        if self.progress is not None:
            self.progress(self.t[self.reached])

    def _check(self, k: int, z: np.ndarray) -> None:
        if k % self.every == 0:
            h = (self.t[k + 1] - self.t[k]) / self.counts[k]
            check_step(self.plant, z, self.method, h, u=self.drive.samples[k], p=self.p, t=self.t[k])

    def _check_passed(self, first: int, last: int, z: np.ndarray) -> None:
        """`_check` at the starts of intervals first .. last - 1, which compiled code has gone through."""
        k, reached = np.arange(-(-first // self.every) * self.every, last, self.every), self.reached
        steps = (self.t[k + 1] - self.t[k]) / self.counts[k]
        for i in doubtful(self.plant, z[k], self.method, steps, self.drive.samples[k], self.p):
            self.reached = int(k[i])  # what came later tells nothing where this one is past the limit
            self._check(self.reached, z[self.reached])
        self.reached = reached

    def _fixed(self, k: int, z: np.ndarray, start: int = 0) -> np.ndarray:
        began, count = self.t[k], int(self.counts[k])
        h = (self.t[k + 1] - began) / count
        if not start:
            self._check(k, z)
        step, law = stepper(self.plant, self.method), self.drive.law
        at_times = np.array(METHODS[self.method].input_times)
        held = np.tile(self.drive.samples[k], len(at_times))
        with np.errstate(all="ignore"):
            for i in range(start, count):
                at = began + i * h
                if law is not None:
                    held = self.drive.at(at + at_times * h)
                after = step(at, z, held, self.w, self.p, h)[0]
                if not np.isfinite(after).all():
                    raise diverged(self.method, float(at), z, h)
                z = after
        self.steps += count - start
        return z

    def _first_step(self, k: int, z: np.ndarray) -> float:
        """Of the adaptive methods, from time k on; under a smooth input no longer than the run."""
        if self.first is None:
            at = (self.t[k], z[: self.plant.nx], self.drive.samples[k])
            self.first = dormand_prince.first_step(self.plant, *at, self.w, self.p)
            if self.drive.smooth:
                self.first = min(self.first, self.t[-1] - self.t[0])
        return self.first

    def _adaptive_natively(self, library: MotionLibrary, z: np.ndarray) -> None:
        k = self.reached
        arrays = (np.ascontiguousarray(self.t), self.drive.samples, self.w, self.p, z)
        motion = library.adapted(arrays, (self.rtol, self.atol, *dormand_prince.limits()))
        stopped = motion.march(k, self._ahead(), self._first_step(k, z[k]), restart=not self.drive.smooth)
        self.reached, self.first = motion.reached, motion.step
        self.steps, self.native = self.steps + motion.tried, self.native + motion.tried
        if stopped:
            last = z[self.reached + 1]
            if stopped == TOO_MANY:
                raise dormand_prince.too_many_steps(motion.time, last, motion.trial)
            raise dormand_prince.too_small_a_step(motion.time, last, motion.step, len(last))
        if self.progress is not None:
            self.progress(self.t[self.reached])

    def _adaptive(self, times: np.ndarray, z: np.ndarray, k: int) -> np.ndarray:
        first, law = self._first_step(k, z), self.drive.law is not None
        if not self.drive.smooth:
            first = min(first, times[-1] - times[0])
        at, fixed = (times, z, self.drive.samples[k]), (self.w, self.p)
        options: dict[str, Any] = {"rtol": self.rtol, "atol": self.atol, "first": first}
        with np.errstate(all="ignore"):
            if self.method == "radau":
                out, tried = radau.march(self.plant, *at, self.drive if law else None, *fixed, **options)
            else:
                options |= {"audit": self.audit, "report": self.progress}
                function = self.drive.at if law else None
                out, tried, self.first = dormand_prince.march(self.plant, *at, function, *fixed, **options)
        self.steps += tried
        return out

    def _cvodes(self, k: int, z: np.ndarray) -> np.ndarray:
        if self.drive.law is not None:
            raise ValueError('method = "cvodes" needs an input held between times: give an array, not a callable')
        at = (self.t[k], self.t[k + 1], z, self.drive.samples[k])
        return cvodes.advance(self.plant, *at, self.w, self.p, self.rtol, self.atol)

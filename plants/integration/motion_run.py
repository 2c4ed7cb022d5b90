"""One simulation on its way: the state at every time, interval by interval where the input is held.

In compiled code from where that is at hand or pays, on the virtual machine until then.
"""

from __future__ import annotations

import time as clock
from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.errors import IntegrationError, StabilityLimitError
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.motions import adaptive_steps, tape_motion
from pliant.plants.motions.compile_rule import OnDemand
from pliant.plants.motions.held_inputs import HeldInput
from pliant.plants.motions.motion_library import A_CALL, LONG
from pliant.plants.motions.motion_source import PAIR
from pliant.plants.motions.time_limit import check_time
from pliant.plants.rosenbrock.adaptive import RosenbrockMotion, next_jumps
from pliant.plants.rosenbrock.library import adaptive_kernel

from . import dormand_prince
from .batch_stepper import motion_kernel
from .step_guard import diverged
from .step_maps import METHODS, check_step, doubtful, stepper

Array = np.ndarray
TOLD = 200  # parts of a compiled motion after which progress is told, at most
CHECKS = 8  # how often along a fixed-step run the step limit is looked at again


@dataclass
class MotionRun:
    """The states x (nt, nx) at all times of t; `steps` that were taken or tried, `native` of them in compiled code."""

    plant: PlantLike
    drive: HeldInput
    t: Array
    x0: Array
    w: Array
    p: Array
    method: str
    step: float | None
    rtol: float
    atol: float
    audit: bool
    progress: Any

    def __post_init__(self) -> None:
        self.z0 = np.append(self.x0, 0.0) if self.audit else self.x0
        self.steps = self.native = self.reached = 0  # and intervals that are done
        self.intervals = len(self.t) - 1
        self.kernel: OnDemand[Any] | None = None
        self.evaluations = 1  # of the rates in a step
        self.library: Any = None
        self.slow = 0.0  # [s] spent on the virtual machine
        self.prepare()

    @abstractmethod
    def prepare(self) -> None:
        """What a kind of method needs besides."""

    @abstractmethod
    def on_the_virtual_machine(self, z: Array) -> None:
        """One interval or more of the rows z (nt, nz)."""

    def natively(self, z: Array) -> None:
        """As far as the input is known."""

    def expected_steps(self) -> int:
        """Of the whole motion; of adaptive steps, whose number nobody knows before, one an interval."""
        return self.intervals

    def march(self) -> tuple[Array, Array]:
        """States (nt, nx) and net work (nt,) at all times."""
        nx = self.plant.nx
        z = np.empty((len(self.t), len(self.z0)))
        z[0] = self.z0
        try:
            while self.reached < self.intervals:
                check_time(self.t[self.reached])
                self.drive.decide(self.reached, z[self.reached][:nx])
                self._look_for_library()
                if self.library is None:
                    if not self.reached:  # raises where the start is singular; of compiled motions their rates do
                        self.plant.dynamics(z[0, :nx], w=self.w, p=self.p, t=self.t[0])
                    self._slowly(z)
                else:
                    self.natively(z)
                    if self.progress is not None:
                        self.progress(self.t[self.reached])
            self.drive.decide(self.intervals, z[-1][:nx])
        except (IntegrationError, StabilityLimitError) as stopped:
            last = getattr(stopped, "state", z[self.reached])[:nx]
            self.plant.explain_stop(z[: self.reached + 1, :nx], last, self.w, self.p)
            raise
        return z[:, :nx], z[:, nx] if self.audit else np.zeros(len(self.t))

    def _look_for_library(self) -> None:
        """Take the compiled motions where they are at hand or worth it: asked at the start, and of adaptive steps again
        after 1, 2, 4, .. intervals.
        """
        k = self.reached
        if self.kernel is None or self.library is not None or k & (k - 1) or (k and self.step is not None):
            return
        coming = self.kernel.seconds(self.expected_steps(), self.evaluations)
        self.library = self.kernel.library(max(coming, self.slow * (self.intervals - k) / k) if k else coming)

    def _slowly(self, z: Array) -> None:
        began, before = clock.perf_counter(), self.steps
        self.on_the_virtual_machine(z)
        if self.kernel is not None:  # what is built on the way is not what steps cost
            taken = self.kernel.seconds(self.steps - before, self.evaluations)
            self.slow += (taken := min(clock.perf_counter() - began, taken))
            self.kernel.spent += taken

    def next_part(self) -> int:
        """The row to which adaptive steps go on before a library is looked for again: under a smooth input as many
        intervals as are done, or all where no library is to be expected.
        """
        all_at_once = self.drive.smooth and (self.kernel is None or self.kernel.settled)
        more = self.intervals if all_at_once else max(1, self.reached if self.drive.smooth else 1)
        return min(self.intervals, self.reached + more)

    def ahead(self) -> int:
        """How far the input is known without asking a controller, in parts of which progress can be told."""
        if self.drive.controller is not None or self.drive.law is not None:
            return self.reached + 1
        part = self.intervals if self.progress is None else -(-self.intervals // TOLD)
        return min(self.intervals, self.reached + part)

    def first_step(self, k: int, z: Array) -> float:
        """Of adaptive methods, from time k on; under a smooth input no longer than the run."""
        at = (self.t[k], z[: self.plant.nx], self.drive.samples[k])
        found = dormand_prince.first_step(self.plant, *at, self.w, self.p)
        return min(found, self.t[-1] - self.t[0]) if self.drive.smooth else found


class FixedRun(MotionRun):
    """Steps of a length that is given, the limit looked at on the way."""

    def prepare(self) -> None:
        self.every = max(1, self.intervals // CHECKS)
        self.counts = np.maximum(1, np.ceil(np.diff(self.t) / self.step * (1 - 1e-12))).astype(LONG)
        self.long = self.counts.sum() > A_CALL
        self.kernel, tableau = motion_kernel(self.plant, self.method), METHODS[self.method].tableau
        self.evaluations = len(tableau.b) if tableau else 1
        self.motion: Any = None

    def expected_steps(self) -> int:
        return int(self.counts.sum())

    def on_the_virtual_machine(self, z: Array) -> None:
        z[self.reached + 1] = self._steps(self.reached, z[self.reached])
        self.reached += 1
        if self.progress is not None:
            self.progress(self.t[self.reached])

    def natively(self, z: Array) -> None:
        if self.motion is None:
            given = (np.ascontiguousarray(self.t), self.counts, self.drive.samples)
            self.motion = self.library.stepped(self.method, given, (self.w, self.p, z))
        k, checked = self.reached, self.long
        if checked:  # beforehand, so that no long run is in vain
            self._check(k, z[k])
        if self.drive.law is None:
            done = self.motion.march(k, self.ahead())
        else:
            done = self.motion.march_sampled(k, METHODS[self.method].input_times, self.drive.at)
        self.reached, i = self.motion.place
        self._check_passed(k + checked, self.reached + (not done), z)
        taken = int(self.counts[k : self.reached].sum()) + i
        self.steps, self.native = self.steps + taken, self.native + taken
        if not done:  # the virtual machine has the last word, and the words
            j = self.reached
            z[j + 1] = self._steps(j, z[j + 1 if i else j], start=i)
            self.reached += 1

    def _check(self, k: int, z: Array) -> None:
        if k % self.every == 0:
            h = (self.t[k + 1] - self.t[k]) / self.counts[k]
            check_step(self.plant, z, self.method, h, u=self.drive.samples[k], p=self.p, t=self.t[k])

    def _check_passed(self, first: int, last: int, z: Array) -> None:
        """`_check` at the starts of intervals first .. last - 1, which compiled code has gone through."""
        k, reached = np.arange(-(-first // self.every) * self.every, last, self.every), self.reached
        steps = (self.t[k + 1] - self.t[k]) / self.counts[k]
        for i in doubtful(self.plant, z[k], self.method, steps, self.drive.samples[k], self.p, self.t[k]):
            self.reached = int(k[i])  # what came later tells nothing where this one is past the limit
            self._check(self.reached, z[self.reached])
        self.reached = reached

    def _steps(self, k: int, z: Array, start: int = 0) -> Array:
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
                check_time(at)
                if law is not None:
                    held = self.drive.at(at + at_times * h)
                after = step(at, z, held, self.w, self.p, h)[0]
                if not np.isfinite(after).all():
                    raise diverged(self.method, float(at), z, h)
                z = after
        self.steps += count - start
        return z


class PairRun(MotionRun):
    """dop853: steps of its own that end on every time."""

    def prepare(self) -> None:
        self.first: float | None = None
        if self.drive.law is None and not self.audit:
            self.kernel, self.evaluations = motion_kernel(self.plant, PAIR), dormand_prince.STAGES

    def on_the_virtual_machine(self, z: Array) -> None:
        coming = self.kernel.seconds(self.expected_steps(), self.evaluations) if self.kernel and not self.reached else 0
        if self.kernel and (tape := tape_motion.at_hand(self.plant, coming)):
            return self._by_tape(z, *tape)
        k, end = self.reached, self.next_part()
        times, function = self.t[k : end + 1], None if self.drive.law is None else self.drive.at
        self.first = self.first_step(k, z[k]) if self.first is None else self.first
        first = self.first if self.drive.smooth else min(self.first, times[-1] - times[0])
        options: dict[str, Any] = {"rtol": self.rtol, "atol": self.atol, "first": first, "before": self.steps}
        given = (times, z[k], self.drive.samples[k], function, self.w, self.p)
        with np.errstate(all="ignore"):
            found = dormand_prince.march(self.plant, *given, audit=self.audit, report=self.progress, **options)
        z[k : end + 1], tried, self.first = found
        self.steps, self.reached = self.steps + tried, end

    def _by_tape(self, z: Array, tape: Any, run: Any) -> None:
        """As far again as it has come, after which a library is looked for."""
        arrays = (np.ascontiguousarray(self.t), self.drive.samples, self.w, self.p, z)
        motion = tape.adapted(run, arrays, (self.rtol, self.atol, *adaptive_steps.limits()))
        self._along(motion, z, min(max(1, 2 * self.reached), self.ahead()))
        if self.progress is not None:
            self.progress(self.t[self.reached])

    def natively(self, z: Array) -> None:
        arrays = (np.ascontiguousarray(self.t), self.drive.samples, self.w, self.p, z)
        motion = self.library.adapted(arrays, (self.rtol, self.atol, *adaptive_steps.limits()))
        before = self.steps
        self._along(motion, z, self.ahead())
        self.native += self.steps - before

    def _along(self, motion: Any, z: Array, end: int) -> None:
        k = self.reached
        before, self.first = self.steps, self.first_step(k, z[k]) if self.first is None else self.first
        status = motion.march(k, end, self.first, before, restart=not self.drive.smooth)
        self.reached, self.first, self.steps = motion.reached, motion.step, motion.tried
        if status:
            last = z[self.reached + 1]
            raise adaptive_steps.stopped(status, motion.time, last, motion.step, motion.trial, self.method)


class RosenbrockRun(MotionRun):
    """Steps that may go past the times on their way, which come from dense output."""

    def prepare(self) -> None:
        drive, law = self.drive, None if self.drive.law is None else self.drive.at
        if drive.controller is not None:  # nobody knows what it will say
            ends = np.arange(1, self.intervals + 1)
        else:
            ends = next_jumps(drive.samples if law is None else np.zeros((self.intervals + 1, 1)))
        given = self.plant, self.t, drive.samples, law, self.w, self.p
        self.motion = RosenbrockMotion(*given, rtol=self.rtol, atol=self.atol, ends=ends)
        if law is None:
            self.kernel, self.evaluations = adaptive_kernel(self.plant), len(self.motion.tableau.d)

    def on_the_virtual_machine(self, z: Array) -> None:
        with np.errstate(all="ignore"):
            self._further(z, lambda: self.motion.march(z, self.next_part(), self.progress))

    def natively(self, z: Array) -> None:
        before = self.steps
        try:
            self._further(z, lambda: self.motion.march_natively(self.library, z, self.ahead()))
        finally:
            self.native += self.steps - before

    def _further(self, z: Array, march: Any) -> None:
        if not self.steps:
            self.motion.begin(float(self.t[0]), z[0], self.first_step(0, z[0]))
        try:
            march()
        finally:
            self.steps, self.reached = self.motion.steps, self.motion.row

"""Drive a plant through time: inputs of any form, fixed or adaptive steps, failures with time, state and step."""

from __future__ import annotations

import time as clock
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_function, require_number, shown
from pliant.plants.core.errors import IntegrationError, StabilityLimitError
from pliant.plants.core.parameters import require_choice, require_parts, require_seconds
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.signals import read_only_times
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.validity.ranges import judged

from . import cvodes, radau
from .dormand_prince import MOST_STEPS, march
from .held_inputs import HeldInput, Input, sampling_grid
from .step_maps import METHODS, check_step, stepper

ADAPTIVE = ("dop853", "radau")
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
        require_parts("step", step, float(t[-1] - t[0]), MOST_STEPS, "steps")
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

    began = clock.perf_counter()
    grid, rows = sampling_grid(t, u)
    drive = HeldInput(plant, u, grid, w, p)
    run = _Run(plant, drive, grid, x, w, p, method, step, rtol, atol, audit, progress)
    states, work, samples = (z[rows] for z in (*run.march(), drive.samples))
    dx = plant.dynamics(states, samples, w=w, p=p, t=t)
    stats: dict[str, Any] = {
        "method": method,
        "seconds": clock.perf_counter() - began,
        "steps": run.steps,
        "step": step,
    }
    if audit:
        energy = plant.energy(states, p=p)  # type: ignore[attr-defined]
        largest = np.abs(energy).max() or 1.0
        stats["energy_balance"] = float(np.abs(energy - energy[0] - work).max() / largest)
    made = Trajectory(
        t=t,
        x=states,
        u=samples,
        y=plant._output(t[:, None], states, samples, w, p, batch=len(t))[0],
        states=plant.states,
        inputs=plant.inputs,
        outputs=plant.outputs,
        dx=dx,
        w=np.tile(w, (len(t), 1)),
        disturbances=plant.disturbances,
        hold="linear" if drive.smooth else "zero-order",
        stats=stats,
    )
    return judged(plant, made, p, stacklevel=3)


class _Run:
    """One simulation: the state at every time of t, interval by interval where the input is held."""

    def __init__(
        self,
        plant: PlantLike,
        drive: HeldInput,
        t: np.ndarray,
        x0: np.ndarray,
        w: np.ndarray,
        p: np.ndarray,
        method: str,
        step: float | None,
        rtol: float,
        atol: float,
        audit: bool,
        progress: Any,
    ) -> None:
        self.plant, self.drive, self.t, self.method, self.step = plant, drive, t, method, step
        self.rtol, self.atol, self.progress = rtol, atol, progress
        self.w, self.p = w, p
        self.audit = audit
        self.first: float | None = None
        self.z0 = np.append(x0, 0.0) if audit else x0
        self.steps = 0

    def march(self) -> tuple[np.ndarray, np.ndarray]:
        """States (nt, nx) and net work (nt,) at all times."""
        nx, k = self.plant.nx, 0
        z = np.empty((len(self.t), len(self.z0)))
        z[0] = self.z0
        self.plant.dynamics(z[0, :nx], w=self.w, p=self.p, t=self.t[0])  # raises where the start is singular
        try:
            if self.method in ADAPTIVE and self.drive.smooth:
                z[:] = self._adaptive(self.t, z[0], 0)
            else:
                for k in range(len(self.t) - 1):
                    self.drive.decide(k, z[k][:nx])
                    z[k + 1] = self._interval(k, z[k])
                    if self.progress is not None:
                        self.progress(self.t[k + 1])
                self.drive.decide(len(self.t) - 1, z[-1][:nx])
        except (IntegrationError, StabilityLimitError) as stopped:
            last = getattr(stopped, "state", z[k])[:nx]
            self.plant.explain_stop(z[: k + 1, :nx], last, self.w, self.p)
            raise
        return z[:, :nx], z[:, nx] if self.audit else np.zeros(len(self.t))

    def _interval(self, k: int, z: np.ndarray) -> np.ndarray:
        if self.method in ADAPTIVE:
            return self._adaptive(self.t[k : k + 2], z, k)[-1]
        if self.method == "cvodes":
            return self._cvodes(k, z)
        return self._fixed(k, z)

    def _fixed(self, k: int, z: np.ndarray) -> np.ndarray:
        began, ended = self.t[k], self.t[k + 1]
        count = max(1, int(np.ceil((ended - began) / self.step * (1 - 1e-12))))
        h = (ended - began) / count
        if k % max(1, (len(self.t) - 1) // CHECKS) == 0:
            check_step(self.plant, z, self.method, h, u=self.drive.samples[k], p=self.p, t=began)
        step, law = stepper(self.plant, self.method), self.drive.law
        at_times = np.array(METHODS[self.method].input_times)
        held = np.tile(self.drive.samples[k], len(at_times))
        with np.errstate(all="ignore"):
            for i in range(count):
                at = began + i * h
                if law is not None:
                    held = self.drive.at(at + at_times * h)
                after = step(at, z, held, self.w, self.p, h)[0]
                if not np.isfinite(after).all():
                    raise IntegrationError(
                        f"{self.method} diverged at t = {at:.6g} s with a step of {h:.4g} s from state {z}; "
                        "take a smaller step or an adaptive method",
                        float(at),
                        z,
                        h,
                    )
                z = after
        self.steps += count
        return z

    def _adaptive(self, times: np.ndarray, z: np.ndarray, k: int) -> np.ndarray:
        held = self.drive.samples[k]
        if self.first is None:
            # At an exact equilibrium every error estimate is zero and the first step would be as long as the run.
            fastest = np.abs(np.linalg.eigvals(self._slopes(times[0], z[: self.plant.nx], held))).max(initial=0.0)
            self.first = 0.1 / max(fastest, 1e-3)
        with np.errstate(all="ignore"):
            if self.method == "radau":
                tolerances = {"rtol": self.rtol, "atol": self.atol}
                first = min(self.first, times[-1] - times[0])
                law = self.drive if self.drive.law else None
                out, tried = radau.march(self.plant, times, z, held, law, self.w, self.p, first=first, **tolerances)
                self.steps += tried
                return out
            out, tried, self.first = march(
                self.plant,
                times,
                z,
                held,
                self.drive.at if self.drive.law else None,
                self.w,
                self.p,
                rtol=self.rtol,
                atol=self.atol,
                first=min(self.first, times[-1] - times[0]),
                audit=self.audit,
                report=self.progress,
            )
        self.steps += tried
        return out

    def _slopes(self, t: float, x: np.ndarray, u: np.ndarray) -> np.ndarray:
        """df/dx (nx, nx) to half the digits, by differences: a first step needs no more, and the exact Jacobian of a
        large plant takes seconds to build.
        """
        moves = np.sqrt(np.finfo(float).eps) * np.maximum(np.abs(x), 1.0)
        points = np.vstack([x, x + np.diag(moves)])
        rate = np.array([self.plant._dynamics(t, at, u, self.w, self.p)[0] for at in points])
        return ((rate[1:] - rate[0]) / moves[:, None]).T

    def _cvodes(self, k: int, z: np.ndarray) -> np.ndarray:
        if self.drive.law is not None:
            raise ValueError('method = "cvodes" needs an input held between times: give an array, not a callable')
        return cvodes.advance(
            self.plant,
            self.t[k],
            self.t[k + 1],
            z,
            self.drive.samples[k],
            self.w,
            self.p,
            self.rtol,
            self.atol,
        )

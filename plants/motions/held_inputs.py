"""The input of one simulation in any form: constant, held by intervals, a function of time, or a controller."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from pliant.plants.core.argument_gates import real_array
from pliant.plants.core.parameters import require_finite, require_parts, require_seconds
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.signals import index


class Acts(Protocol):
    """What `simulate` needs of a controller."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray: ...


Input = None | np.ndarray | tuple[float, ...] | list[float] | Callable[[float], Any] | Acts
MOST_SAMPLES = 10_000_000  # of a controller in one simulation: each takes a state in memory
SAME_TIME = 1e-6  # of the sampling period: times this close are one


def sampling_grid(t: np.ndarray, u: Input) -> tuple[np.ndarray, np.ndarray]:
    """t with the sampling times of a controller put in between, and the places of t's own times in it."""
    period = getattr(u, "dt", None) if hasattr(u, "act") else None
    if period is None:
        return t, np.arange(len(t))
    period = require_seconds("controller dt", period)
    require_parts("controller dt", period, float(t[-1] - t[0]), MOST_SAMPLES, "samples")
    ticks = t[0] + period * np.arange(1, int(np.ceil((t[-1] - t[0]) / period)))
    after = np.searchsorted(t, ticks)
    gap = np.minimum(np.abs(t[after] - ticks), np.abs(t[after - 1] - ticks))
    grid = np.sort(np.concatenate([t, ticks[gap > SAME_TIME * period]]))
    return grid, np.searchsorted(grid, t)


class HeldInput:
    """The input over time: `smooth` as a function of time, or constant over each interval of t."""

    def __init__(self, plant: PlantLike, u: Input, t: np.ndarray, w: np.ndarray, p: np.ndarray) -> None:
        self.plant, self.t, self.w, self.p = plant, t, w, p
        self.samples = np.zeros((len(t), plant.nu))
        self.controller: Any = u if hasattr(u, "act") else None
        self.law: Any = u if callable(u) and self.controller is None else None
        together = getattr(self.law, "at_times", None)
        self.together: Any = together if callable(together) else None
        self.smooth = self.law is not None
        if self.controller is not None:
            self._choose_reads()
        elif self.law is not None:
            self.samples[:] = self.at(t).reshape(len(t), -1)
        elif u is not None:
            array = real_array(f"{type(plant).__name__}.u", u)
            shape = (len(t), plant.nu) if array.ndim == 2 else (plant.nu,)
            self.samples[:] = require_finite(f"{type(plant).__name__}.u", array, shape)
            self.smooth = array.ndim == 1
        else:
            self.smooth = True

    def _choose_reads(self) -> None:
        reads = tuple(getattr(self.controller, "reads", ()) or (s.name for s in self.plant.outputs))
        known = self.plant.states + self.plant.outputs
        self.picks = [index(known, name, "state or output") for name in reads]
        self.period = getattr(self.controller, "dt", None)
        self.taken = 0
        if hasattr(self.controller, "reset"):
            self.controller.reset()

    def __call__(self, time: float) -> np.ndarray:
        value = real_array(f"u({time:.6g})", self.law(time)).reshape(-1)
        if value.shape != (self.plant.nu,) or not np.isfinite(value).all():
            raise ValueError(f"u({time:.6g}) = {value} must be {self.plant.nu} finite numbers")
        return value

    def at(self, times: np.ndarray) -> np.ndarray:
        """The law's values at `times`, (len(times) * nu,): by its own `at_times` at once, else one by one."""
        if self.together is not None:
            shape = (len(times), self.plant.nu)
            return require_finite(f"u.at_times of {len(times)} times", self.together(times), shape).ravel()
        values = [real_array("u(t)", self.law(time)).reshape(-1) for time in times]
        together = np.concatenate(values)
        if any(len(value) != self.plant.nu for value in values) or not np.isfinite(together).all():
            return np.concatenate([self(time) for time in times])  # says which
        return together

    def decide(self, k: int, x: np.ndarray) -> None:
        """Ask a sampled controller for the input held from t[k] on."""
        if self.controller is None:
            return
        now = self.t[k]
        if self.period is None or now >= self.t[0] + self.period * (self.taken - SAME_TIME):
            previous = self.samples[max(k - 1, 0)]
            y = self.plant._output(now, x, previous, self.w, self.p)[0]
            u = real_array("controller.act", self.controller.act(float(now), np.append(x, y)[self.picks])).reshape(-1)
            if u.shape != (self.plant.nu,) or not np.isfinite(u).all():
                raise ValueError(f"controller at t = {now:.6g} s gave {u}, must be {self.plant.nu} finite numbers")
            self.samples[k] = u
            self.taken += 1
        else:
            self.samples[k] = self.samples[k - 1]

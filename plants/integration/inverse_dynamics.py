"""Inputs that take a plant from rest to rest, by inverse dynamics at each time.

M q'' = f + B u has one u for each q'' wanted where one input drives each moved coordinate. Many times are evaluated at
once: an integrator asks for all stages of a step together, and the plant's functions cost little more for twelve points
than for one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_seconds
from pliant.plants.core.signals import OwnsArrays, names

from .minimum_jerk import profile_of

Array = np.ndarray


def rest_to_rest_ends(plant: Any, begin: Any, end: Any, time: Any) -> tuple[Array, Array, float]:
    """The states (nx,), copies, and the time [s] between which a plant is to move; ValueError names what is none."""
    first, last = (
        np.array(require_finite(f"rest_to_rest.{name}", x, (plant.nx,))) for name, x in (("begin", begin), ("end", end))
    )
    return first, last, require_seconds("rest_to_rest.time", time)


class InverseDynamics(OwnsArrays):
    """u(t) (nu,) along x(t) (nx,) whose moved coordinates go from `begin` to `end` (nx,) in `time` [s].

    Moved are all coordinates where there are as many inputs, else those of the joints, with the others held at `begin`:
    the inputs are then right while the others do not move. ValueError where the inputs and the moved do not match.

    >>> arm = TwoLinkArm.textbook().ladder()[0]
    >>> u = arm.rest_to_rest(np.zeros(4), np.array([1.0, 0.5, 0.0, 0.0]), time=1.0)
    >>> u(0.25), u.at_times(np.linspace(0, 1, 5))  # (2,), (5, 2)
    """

    def __init__(self, plant: Any, begin: Array, end: Array, time: float, profile: str = "minimum-jerk") -> None:
        known = names(plant.states)
        moved = tuple(plant.rates) if len(plant.rates) == plant.nu else tuple(j.position for j in plant.joints)
        if len(moved) != plant.nu or not set(moved) <= set(plant.rates):
            raise ValueError(
                f"inputs that drive one coordinate each: the {plant.nu} of {type(plant).__name__} ({plant.label}) "
                f"drive {', '.join(moved) or 'none'}; give the inputs as functions of time instead"
            )
        self.plant, self.profile = plant, profile
        self._motion = profile_of("rest_to_rest", profile)
        self._start, last, self.time = rest_to_rest_ends(plant, begin, end, time)
        self._q = [known.index(name) for name in moved]
        self._v = [known.index(plant.rates[name]) for name in moved]
        self._way = last[self._q] - self._start[self._q]
        self._held: Array | None = None  # the input at the end, once it is known

    def __call__(self, t: float) -> Array:
        """The inputs (nu,) at one time; those of the end from then on."""
        if t < self.time:
            return self._inputs(np.array([t]))[0]
        if self._held is None:
            self._held = self._inputs(np.array([self.time]))[0]
        return self._held.copy()

    def at_times(self, times: Array) -> Array:
        """The inputs (n, nu) at times (n,)."""
        if np.min(times, initial=np.inf) >= self.time:
            return np.tile(self(self.time), (len(times), 1))
        return self._inputs(times)

    def _carried(self, x: Array) -> Array:
        """States (n, nx) with what moves along where the moved coordinates do: nothing."""
        return x

    def _inputs(self, times: Array) -> Array:
        s, ds, dds = (np.multiply.outer(part, self._way) for part in self._motion(times / self.time))
        x, still = np.tile(self._start, (len(times), 1)), np.zeros(self.plant.nu)
        x[:, self._q], x[:, self._v] = self._start[self._q] + s, ds / self.time
        x = self._carried(x)
        free = self.plant.dynamics(x, still)[:, self._v]
        B = self.plant.jacobians(x, still)[1][:, self._v]
        return np.linalg.solve(B, (dds / self.time**2 - free)[:, :, None])[:, :, 0]

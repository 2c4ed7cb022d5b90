"""What keeps a batch of fixed steps to the word of `simulate`: its stability limit, and lanes that stay numbers.

The limit is that of the plant at rest when a stepper is made, and at the lanes themselves when it first runs and
whenever a lane's parameters leave what was looked at so far. Lanes are looked at for NaN and infinity after 1, 2, 4, ..
64 and then every 64 calls, so that the look costs little beside the steps.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from pliant.plants.core.errors import DivergenceWarning, IntegrationError
from pliant.plants.core.parameters import LONGEST, SHORTEST, require_count, require_seconds
from pliant.plants.core.plant_protocol import PlantLike

from .step_maps import METHODS, check_step

Array = np.ndarray
LOOKED_AT = 4  # lanes of a batch, spread evenly, beside those of extreme parameters
EVERY = 64  # calls between looks at the lanes


class StepGuard:
    """The checks of steps of `h` [s] by `method`, batch after batch. `check` False leaves the limit to the caller."""

    def __init__(self, plant: PlantLike, method: str, h: float, *, check: bool) -> None:
        self.plant, self.method, self.h = plant, method, h
        self.calls, self._told = 0, False
        self._limited = check and METHODS[method].tableau is not None
        self._box: tuple[Array, Array] | None = None  # least and largest parameters looked at
        if self._limited:
            self._check(plant.rest_state, None, plant.nominal_parameters, 0.0)

    def before(self, x: Array, u: Array, p: Array, new: bool, t: float) -> None:
        """Look at lanes x (batch, nx), u (batch, nu), p (batch, np) before the first call, and where p is `new`.

        Raises StabilityLimitError.
        """
        if not self._limited or (self._box is not None and not new):
            return
        low, high = p.min(axis=0), p.max(axis=0)
        if self._box is None:
            lanes = set(np.linspace(0, len(x) - 1, min(LOOKED_AT, len(x))).astype(int).tolist())
        else:
            least, most = self._box
            if (low >= least).all() and (high <= most).all():
                return
            lanes, low, high = set(), np.minimum(low, least), np.maximum(high, most)
        self._box = low, high
        for lane in sorted(lanes | {*p.argmin(axis=0).tolist(), *p.argmax(axis=0).tolist()}):
            self._check(x[lane], u[lane], p[lane], t)

    def _check(self, x: Array, u: Array | None, p: Array, t: float) -> None:
        """At one point; where its linear model is not finite there is no limit to tell."""
        values, _ = self.plant._arguments(np.zeros(self.plant.nx), u, None, p, t)
        values = (values[0], np.asarray(x, dtype=float), *values[2:])
        if np.isfinite(values[1]).all() and np.isfinite(self.plant._jacobians(*values)[0]).all():
            check_step(self.plant, values[1], self.method, self.h, u=u, p=p, t=t)

    def after(self, x: Array) -> None:
        """Warn (DivergenceWarning, once) where lanes of x (batch, nx) are no longer finite."""
        self.calls += 1
        if self._told or (self.calls & (self.calls - 1) if self.calls < EVERY else self.calls % EVERY):
            return
        good = sound(x)
        if not good.all():
            self._told = True
            warnings.warn(
                f"stepper: {np.count_nonzero(~good)} of {len(good)} lanes are no longer finite after {self.calls} "
                f"calls ({self.method}, steps of {self.h:.4g} s), lane {int(np.argmin(good))} first; `sound` tells "
                "which. Take shorter steps, or start these lanes again",
                DivergenceWarning,
                stacklevel=3,
            )


def sound(x: Any) -> Array:
    """Which lanes of x (batch, nx) are finite numbers: (batch,) bool."""
    return np.isfinite(x).all(axis=1)


def diverged(method: str, t: float, x: Array, h: float) -> IntegrationError:
    """What ends a motion whose step of h [s] from state x at t has no finite result."""
    return IntegrationError(
        f"{method} diverged at t = {t:.6g} s with a step of {h:.4g} s from state {x}; take a smaller step or an "
        "adaptive method",
        t,
        x,
        h,
    )


def require_steps(owner: str, plant: PlantLike, dt: Any, substeps: Any, batch: Any) -> tuple[float, int, int]:
    """dt [s], substeps and batch of a control period of RK4 steps; ValueError that names owner and field.

    Raises StabilityLimitError where a substep is past RK4's limit at rest.
    """
    dt = require_seconds(f"{owner}.dt", dt, SHORTEST, LONGEST)
    batch = require_count(owner, "batch", batch, 1, 1_000_000)
    substeps = require_count(owner, "substeps", substeps, 1, 1_000_000)
    StepGuard(plant, "rk4", dt / substeps, check=True)
    return dt, substeps, batch

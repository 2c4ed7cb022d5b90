"""What an optimisation starts from, p = [x, x_s, u_s, d, u_-1]: the state as it is read, or what is estimated, its
steady target under the estimated disturbance, and the last input where its change is limited. Of inputs that act late,
those on their way are part of x.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

import numpy as np

from pliant.controllers.base.inputs_on_their_way import OnTheirWay
from pliant.plants.core.signals import OwnsArrays

from .constraints import Limits
from .offset_free import Estimator
from .steady_target import Target


@final
class Knowledge(OwnsArrays):
    """Called with the reading (ny,) it gives p (size,), overwritten by the next call; `remember` takes the input."""

    def __init__(
        self,
        size: int,
        origin: tuple[np.ndarray, np.ndarray, np.ndarray],
        limits: Limits,
        estimator: Estimator | None,
        target: Target | None,
        tracked: Mapping[str, float],
        waiting: np.ndarray | None = None,
    ) -> None:
        """origin: the model's x0 (nx,), u0 (nu,) and the readings there; tracked: signals and their values there;
        waiting (M nu,): inputs on their way at the start, the oldest first, which target and estimator do without."""
        self._x0, self._u0, self._y0 = origin
        self._limits, self._estimator, self._target = limits, estimator, target
        self._low, self._high, self._change = limits.low, limits.high, limits.change
        self.tracked, self.reference = dict(tracked), np.zeros(len(tracked))  # what `aim` asks beyond their values
        nx, nu = len(self._x0), len(self._u0)
        self._p = np.zeros(size)
        self._way = OnTheirWay(np.zeros(0) if waiting is None else waiting, nu)
        self._waiting = self._p[nx : nx + len(self._way.first)]
        self._state, self._origin = self._p[:nx], np.concatenate([self._x0, self._u0])
        self._steady = self._p[nx : 2 * nx + nu]
        self.last = self._p[size - nu :] if limits.remembers else None  # (nu,) the last input
        self._seen = self._p[2 * nx + nu : size - (nu if limits.remembers else 0)]
        self.missed = False  # whether the limits keep the tracked signals from their values
        self.reset()

    def reset(self) -> None:
        """No disturbance, the inputs on their way of the start, and the last input u0, or the limit next to it."""
        self._way.reset()
        self._waiting[:] = self._way.values
        if self._estimator is not None:
            self._estimator.reset()
        if self.last is not None:
            self.last[:] = np.minimum(np.maximum(self._u0, self._low), self._high)

    @property
    def state(self) -> tuple[np.ndarray, np.ndarray | None, np.ndarray | None, bool, bool, np.ndarray]:
        """What it has learnt: goals, the last input, the estimate, whether there is one, whether goals are missed, and
        the inputs on their way."""
        last = None if self.last is None else self.last.copy()
        estimate = None if self._estimator is None else self._estimator.s.copy()
        begun = self._estimator is not None and self._estimator.known
        return self.reference.copy(), last, estimate, begun, self.missed, self._way.values.copy()

    @state.setter
    def state(self, found: tuple[np.ndarray, np.ndarray | None, np.ndarray | None, bool, bool, np.ndarray]) -> None:
        self.reference[:], last, estimate, begun, self.missed, self._way.values = found
        self._waiting[:] = self._way.values
        if self.last is not None:
            self.last[:] = last
        if self._estimator is not None:
            self._estimator.s[:], self._estimator.known = estimate, begun

    def aim(self, values: Mapping[str, float]) -> None:
        """Other values of tracked signals, by name."""
        for name, value in values.items():
            if not np.isfinite(value):
                raise ValueError(f"MPC.aim[{name!r}] = {value!r} must be finite")
            self.reference[list(self.tracked).index(name)] = value - self.tracked[name]

    @property
    def waiting(self) -> np.ndarray:
        """The inputs on their way (M nu,), the oldest first; setting them puts others there."""
        return self._way.values.copy()

    @waiting.setter
    def waiting(self, inputs: np.ndarray) -> None:
        self._way.values[:] = inputs
        self._waiting[:] = inputs

    def __call__(self, y: np.ndarray) -> np.ndarray:
        if self._estimator is None or self._target is None:
            self._state[:] = y
            return self._p
        estimator = self._estimator
        estimator.correct(y - self._y0)
        np.add(self._x0, estimator.x, out=self._state)
        np.add(self._origin, self._target(estimator.d, self.reference), out=self._steady)
        self.missed = self._target.missed
        self._seen[:] = estimator.d[: len(self._seen)]
        return self._p

    def remember(self, u: np.ndarray) -> np.ndarray:
        """u (nu,) with its change limited, in place; it is the last input from now on."""
        if self.last is not None:
            np.minimum(u, self.last + self._change, out=u)
            np.maximum(u, self.last - self._change, out=u)
            self.last[:] = u
        if self._estimator is not None:
            self._estimator.go_on(u - self._u0)
        self._way.push(u)
        self._waiting[:] = self._way.values
        return u

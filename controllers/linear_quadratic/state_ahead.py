"""The state of a plant when the next input begins to act, by its own steps over the inputs on their way."""

from __future__ import annotations

from collections import deque
from typing import Any, final

import numpy as np

from pliant.controllers.riccati.late_inputs import past_of, periods_of
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.dynamics.plant import Plant


@final
class StateAhead(OwnsArrays):
    """Called with x (nx,) it gives x after `delay` periods of `dt` [s], whole ones and a part; `remember` takes what
    was asked for, within the limits. RK4 in `substeps` steps a period."""

    def __init__(self, plant: Plant, dt: float, delay: float, substeps: int, first: np.ndarray) -> None:
        """first (nu,): what acts until the first remembered input does."""
        self.plant, self.dt, self.delay, self.substeps, self.first = plant, dt, delay, substeps, first
        self._compile()
        self.reset()

    def _compile(self) -> None:
        _, part = periods_of(self.delay)
        whole = self.plant.stepper(self.dt, substeps=self.substeps)
        steps = [whole] * past_of(self.delay)
        if part:
            steps[0] = self.plant.stepper(part * self.dt, substeps=max(1, int(np.ceil(part * self.substeps))))
        self._steps = steps

    def reset(self) -> None:
        """Forget the inputs on their way."""
        count = past_of(self.delay)
        self._waiting = deque([self.first] * count, maxlen=count)

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """x (nx,), not finite where the plant diverges on the way."""
        ahead = x[None]
        for step, u in zip(self._steps, self._waiting):
            ahead = step(ahead, u)
        return np.array(ahead[0])

    def last(self) -> np.ndarray:
        """(nu,) the input that will be acting until the next one begins to."""
        return self._waiting[-1]

    def remember(self, u: np.ndarray) -> None:
        """u (nu,), within the limits, was asked for."""
        self._waiting.append(u)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in super().__getstate__().items() if name != "_steps"}  # compiled code

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._compile()

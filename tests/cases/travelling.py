"""How things travel in tests: the scene they are of, a roll of them, and the numbers they are compared by."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from pliant.envs import scenes
from pliant.plants import (
    SingleLinkArm,
    Trajectory,
)  # fmt: skip

Going = Callable[[Any], Any]
RIGID = dataclasses.replace(SingleLinkArm.textbook(), kinematics="rigid")
SLEW = scenes.get("single-link-slew")


@cache
def nominal() -> Trajectory:
    t = np.arange(SLEW.steps + 1) * SLEW.dt
    return SLEW.plant.simulate(SLEW.initial[0], lambda s: [2.0 * np.sin(3 * s)], t)


@dataclasses.dataclass
class Roll:
    """Travellers by name: how each is made, and what it does next."""

    makers: dict[str, Callable[[], Any]] = dataclasses.field(default_factory=dict)
    going: dict[str, Going] = dataclasses.field(default_factory=dict)

    def traveller(self, name: str, go_on: Going) -> Callable[[Callable[[], Any]], Callable[[], Any]]:
        """A decorator of what makes one."""

        def kept(make: Callable[[], Any]) -> Callable[[], Any]:
            self.makers[name], self.going[name] = make, go_on
            return make

        return kept

    def record(self, name: str) -> Callable[[Callable[[], Any]], Callable[[], Any]]:
        """The same of what does nothing but hold numbers."""
        return self.traveller(name, fields)


def fields(thing: Any) -> Any:
    """All numbers and words of a record."""
    if dataclasses.is_dataclass(thing):
        return [fields(getattr(thing, f.name)) for f in dataclasses.fields(thing)]
    if isinstance(thing, (tuple, list)):
        return [fields(part) for part in thing]
    if isinstance(thing, dict):
        return [fields(thing[key]) for key in sorted(thing, key=str)]
    return thing if isinstance(thing, (int, float, complex, str, np.ndarray, np.generic)) else None

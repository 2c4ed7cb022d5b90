"""A pendulum on a trolley, as a user writes it: a machine whose root moves, driven by a force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from pliant.envs.scenes import Scene
from pliant.plants import LagrangianPlant, Signal


@dataclass(frozen=True, kw_only=True)
class Trolley(LagrangianPlant):
    """A load of 5 kg on 3 m of stiff rope under a trolley of 20 kg."""

    coordinates = property(lambda self: (Signal("trolley", "m"), Signal("sway", "rad")))  # type: ignore[assignment]
    inputs = property(lambda self: (Signal("force", "N"),))  # type: ignore[assignment]
    disturbances = property(lambda self: ())  # type: ignore[assignment]
    outputs = property(lambda self: (Signal("load_x", "m"), Signal("load_y", "m")))  # type: ignore[assignment]
    label = property(lambda self: "stiff rope")  # type: ignore[assignment]

    def place(self, q: Any) -> Any:
        return ca.vertcat(q[0] + 3 * ca.sin(q[1]), -3 * ca.cos(q[1]))

    def kinetic_energy(self, q: Any, v: Any) -> Any:
        return 10 * v[0] ** 2 + 2.5 * ca.sumsqr(ca.jtimes(self.place(q), q, v))

    def potential_energy(self, q: Any) -> Any:
        return 5 * 9.81 * self.place(q)[1]

    def dissipation(self, q: Any, v: Any) -> Any:
        return v[0] ** 2 + 0.25 * v[1] ** 2

    def generalized_force(self, t: Any, q: Any, v: Any, u: Any, w: Any) -> Any:
        return ca.vertcat(u, 0)

    def output(self, t: Any, x: Any, u: Any, w: Any) -> Any:
        return self.place(x)

    def outline(self, x: Any, points: int = 30) -> Any:
        return np.linspace([x[0], 0.0], [x[0] + 3 * np.sin(x[1]), -3 * np.cos(x[1])], points)[None]


def trolley() -> Scene:
    """Two metres, rest to rest."""
    return Scene(
        name="trolley",
        about="move a load by two metres",
        plant=Trolley(),
        start=(("trolley", 0.0),),
        goal=(("trolley", 2.0),),
        duration=8.0,
        dt=0.05,
        limits=(100.0,),
        weights=(("load_x", 10.0), ("sway", 1.0)),
        effort=(("force", 1e-4),),
        observe=("trolley", "trolley_rate", "sway", "sway_rate"),
        compare=("load_x", "load_y"),
    )

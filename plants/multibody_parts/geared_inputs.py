"""Inputs of a machine with elastic gears from those of the same machine with stiff ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.signals import OwnsArrays, names
from pliant.plants.integration.inverse_dynamics import rest_to_rest_ends

Array = np.ndarray


class GearedInputs(OwnsArrays):
    """u(t) (nu,) that takes a plant from rest to rest as if its gears did not give: a motor has the torque of its joint
    over the gear's ratio.

    What twists the gears is left out, so that the joints swing about the wanted motion.

    >>> u = GearedInputs(plant, plant.stiff_geared, {"joint_motor_torque": 100.0}, begin, end, 1.0)
    """

    def __init__(
        self,
        plant: Any,
        stiff: Any,
        ratios: dict[str, float],
        begin: Array,
        end: Array,
        time: float,
        profile: str = "minimum-jerk",
    ) -> None:
        """`ratios` by input, of those behind a gear; begin, end: states (nx,) of `plant`."""
        first, last, time = rest_to_rest_ends(plant, begin, end, time)
        at = [names(plant.states).index(name) for name in names(stiff.states)]
        self._inputs = stiff.rest_to_rest(first[at], last[at], time, profile=profile)
        self.time = time
        self._ratios = np.array([ratios.get(name, 1.0) for name in names(plant.inputs)])

    def __call__(self, t: float) -> Array:
        """The inputs (nu,) at one time."""
        return self._inputs(t) / self._ratios

    def at_times(self, times: Array) -> Array:
        """The inputs (n, nu) at times (n,)."""
        return self._inputs.at_times(times) / self._ratios

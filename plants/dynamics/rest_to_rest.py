"""Inputs that move a plant from rest to rest: every coordinate along a minimum-jerk motion, by inverse dynamics."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.minimum_jerk import minimum_jerk
from pliant.plants.core.signals import names

if TYPE_CHECKING:
    from .plant import Plant

Array = np.ndarray


def inverse_dynamics(plant: Plant, begin: Array, end: Array, time: float) -> Callable[[float], Array]:
    """u(t) (nu,) along x(t) (nx,) whose moved coordinates go from `begin` to `end` (nx,) in `time` [s].

    Moved are all coordinates where there are as many inputs, else those of the joints, with the others held at `begin`:
    the inputs are then right while the others do not move. ValueError where the inputs and the moved do not match.
    """
    known = names(plant.states)
    moved = tuple(plant.rates) if len(plant.rates) == plant.nu else tuple(j.position for j in plant.joints)
    if len(moved) != plant.nu or not set(moved) <= set(plant.rates):
        raise ValueError(
            f"inputs that drive one coordinate each: the {plant.nu} of {type(plant).__name__} ({plant.label}) drive "
            f"{', '.join(moved) or 'none'}; give the inputs as functions of time instead"
        )
    q = [known.index(name) for name in moved]
    v = [known.index(plant.rates[name]) for name in moved]
    start, way = np.array(begin, dtype=float), np.asarray(end, dtype=float)[q] - np.asarray(begin, dtype=float)[q]
    still, held = np.zeros(plant.nu), list[Array]()  # held: the input at the end, once it is known

    def drive(t: float) -> Array:
        if t >= time and held:
            return held[0].copy()
        s, ds, dds = minimum_jerk(t / time)
        x = start.copy()
        x[q], x[v] = start[q] + way * s, way * ds / time
        wanted = way * dds / time**2
        free = plant.dynamics(x, still)[v]
        B = plant.jacobians(x, still)[1][v]
        u = np.linalg.solve(B, wanted - free)
        if t >= time:
            held.append(u.copy())
        return u

    return drive

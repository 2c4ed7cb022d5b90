"""What linearly implicit methods take of a plant: its rates, their slopes, and how they change along a direction."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.plant_protocol import PlantLike

Array = np.ndarray


def rate_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p) -> dx/dt as one SX function."""
    return ca.Function("rate", list(plant.symbols), [ca.densify(ca.cse([plant.expressions[0]])[0])])


def changing_in_time(plant: PlantLike) -> bool:
    """Whether the rates depend on time itself."""
    return bool(ca.depends_on(plant.expressions[0], plant.symbols[0]))


def directional_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p, dt, dx) -> the change of dx/dt along (dt, dx): exact, at twice the operations of the rates.

    One call over lanes of unit directions gives as many columns of the Jacobian; written out, that takes some ten times
    the operations, and a compiler as much longer.
    """
    t, x, *_ = plant.symbols
    dt, dx = ca.SX.sym("dt"), ca.SX.sym("dx", plant.nx)
    rate = ca.cse(plant.expressions[0])
    change = ca.jtimes(rate, ca.vertcat(t, x), ca.vertcat(dt, dx))
    return ca.Function("directional", [*plant.symbols, dt, dx], [ca.densify(ca.cse([change])[0])])


@lru_cache(maxsize=32)
def slopes(plant: PlantLike) -> NumericFunction:
    """(t, x, u, w, p) -> [df/dx, df/du] (nx, nx + nu), df/dt (nx, 1), on the virtual machine."""
    drift = ca.jacobian(plant.expressions[0], plant.symbols[0])
    return function("slopes", list(plant.symbols), [plant.slopes(), drift], matrices=True)

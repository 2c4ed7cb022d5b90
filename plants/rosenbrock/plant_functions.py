"""What linearly implicit methods take of a plant: its rates, their slopes, and how they change along a direction."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import LONG, NumericFunction, function
from pliant.plants.core.plant_protocol import PlantLike

Array = np.ndarray
STRAIGHT = 12  # states up to which an implicit step's solution is straight line
WRITTEN_OUT = 60_000  # operations of a Jacobian in C: a compiler takes some 5 s for as many


def rate_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p) -> dx/dt as one SX function."""
    return ca.Function("rate", list(plant.symbols), [ca.densify(ca.cse([plant.expressions[0]])[0])])


def changing_in_time(plant: PlantLike) -> bool:
    """Whether the rates depend on time itself."""
    return bool(ca.depends_on(plant.expressions[0], plant.symbols[0]))


def directional_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p, dt, dx, du) -> the change of dx/dt along (dt, dx, du): exact, at twice the rates' operations.

    One call over lanes of unit directions gives as many columns of the Jacobian; written out, that takes some ten times
    the operations, and a compiler as much longer.
    """
    t, x, u, *_ = plant.symbols
    along = ca.SX.sym("dt"), ca.SX.sym("dx", plant.nx), ca.SX.sym("du", plant.nu)
    change = ca.jtimes(ca.cse(plant.expressions[0]), ca.vertcat(t, x, u), ca.vertcat(*along))
    return ca.Function("directional", [*plant.symbols, *along], [ca.densify(ca.cse([change])[0])])


@lru_cache(maxsize=4)
def whole_slopes(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p) -> df/dx, sparse, and df/dt (nx, 1), dense."""
    drift = ca.jacobian(plant.expressions[0], plant.symbols[0])
    made = ca.Function("whole", list(plant.symbols), [plant.slopes()[:, : plant.nx], ca.densify(drift)])
    if made.n_instructions() > LONG:  # looking for what they have in common takes longer than it saves
        return made
    return ca.Function("whole", list(plant.symbols), ca.cse(made.call(list(plant.symbols))))


def looped(plant: PlantLike) -> bool:
    """Whether the equations of an implicit step are solved by loops; straight line is faster where states are few."""
    return plant.nx > STRAIGHT


def lane_slopes(plant: PlantLike) -> ca.Function:
    """What steps of lanes take the Jacobian from: written out, or one direction after another where that is long."""
    whole = whole_slopes(plant)
    return whole if whole.n_instructions() <= WRITTEN_OUT else directional_function(plant)


@lru_cache(maxsize=32)
def slopes(plant: PlantLike) -> NumericFunction:
    """(t, x, u, w, p) -> [df/dx, df/du] (nx, nx + nu), df/dt (nx, 1), on the virtual machine."""
    drift = ca.jacobian(plant.expressions[0], plant.symbols[0])
    return function("slopes", list(plant.symbols), [plant.slopes(), drift], matrices=True)

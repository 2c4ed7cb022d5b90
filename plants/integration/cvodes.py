"""Adaptive integration by SUNDIALS CVODES (BDF), as built into CasADi: the choice for stiff plants."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.motions.time_limit import steps_of_a_call

MOST_STEPS = 1_000_000  # from one time to the next; fewer under a limit of time, which cannot end them


@lru_cache(maxsize=32)
def _integrator(plant: PlantLike, rtol: float, atol: float, most: int) -> ca.Function:
    """Over a unit of scaled time, so that one object serves every interval, in `most` steps at most."""
    t, x, u, w, p = plant.symbols
    began, length, scaled = ca.SX.sym("began"), ca.SX.sym("length"), ca.SX.sym("s")
    rate = ca.substitute(plant.expressions[0], t, began + length * scaled) * length
    problem = {"t": scaled, "x": x, "p": ca.vertcat(began, length, u, w, p), "ode": ca.cse(rate)}
    options = {"reltol": rtol, "abstol": atol, "max_num_steps": most, "disable_internal_warnings": True}
    return ca.integrator("cvodes", "cvodes", problem, 0.0, 1.0, options)


def advance(
    plant: PlantLike,
    began: float,
    ended: float,
    x: np.ndarray,
    u: np.ndarray,
    w: np.ndarray,
    p: np.ndarray,
    rtol: float,
    atol: float,
) -> np.ndarray:
    """x(ended) from x(began) with the input held."""
    solver = _integrator(plant, rtol, atol, steps_of_a_call(MOST_STEPS))
    try:
        after = solver(x0=x, p=np.concatenate([[began, ended - began], u, w, p]))["xf"]
    except RuntimeError as error:
        raise IntegrationError(
            f"cvodes stopped between t = {began:.6g} s and {ended:.6g} s: {error}", began, x, ended - began
        ) from error
    result = np.asarray(after, dtype=float).reshape(-1)
    if not np.isfinite(result).all():
        raise IntegrationError(f"cvodes gave a non-finite state after t = {began:.6g} s", began, x, ended - began)
    return result

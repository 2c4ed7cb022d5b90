"""Adaptive integration by SciPy's Radau IIA of order 5, with the plant's exact Jacobian."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.motions.time_limit import check_time


def march(
    plant: PlantLike,
    times: np.ndarray,
    x: np.ndarray,
    held: np.ndarray,
    law: Callable[[float], np.ndarray] | None,
    w: np.ndarray,
    p: np.ndarray,
    *,
    rtol: float,
    atol: float,
    first: float,
) -> tuple[np.ndarray, int]:
    """States (nt, nx) at `times` (nt,) [s] from x (nx,), and evaluations of the rate.

    The input is law(t) (nu,), or `held` (nu,) where None; `first` [s] the first step tried. Raises IntegrationError.
    """
    from scipy.integrate import solve_ivp  # 0.2 s to import, and few ask for it

    at = law or (lambda s: held)

    def rate(s: float, z: np.ndarray) -> np.ndarray:
        check_time(s)
        return np.asarray(plant._dynamics(s, z, at(s), w, p)[0])

    solution = solve_ivp(
        rate,
        (times[0], times[-1]),
        x,
        method="Radau",
        t_eval=times,
        rtol=rtol,
        atol=atol,
        first_step=first,
        jac=lambda s, z: plant._jacobians(s, z, at(s), w, p)[0].reshape(plant.nx, plant.nx),
    )
    if not solution.success or not np.isfinite(solution.y).all():
        done = max(solution.y.shape[1] - 1, 0)
        stopped = float(solution.t[done]) if solution.y.size else float(times[0])
        state = solution.y[:, done] if solution.y.size else x
        message = f"radau stopped after t = {stopped:.6g} s at state {state}: {solution.message}"
        raise IntegrationError(message, stopped, state, 0.0)
    return solution.y.T, solution.nfev

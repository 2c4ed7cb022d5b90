"""The cost of a control period to second order, and the steady regulator that goes with it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.objective import Objective
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.controllers.optimal_control.stage_derivatives import StageTerms
from pliant.controllers.riccati.steerable import steerable


def period_cost(J: np.ndarray, nx: int, dt: float, effort: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Q, R, N (B, ..) of one period from the residual's slopes J (B, nr, nx + nu)."""
    H = dt * J.transpose(0, 2, 1) @ J
    return H[:, :nx, :nx], effort * H[:, nx:, nx:], H[:, :nx, nx:]


def law_at_goal(
    about: Objective, terms: StageTerms, substeps: int, effort: float, held: Sequence[str], start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """`steady_law` about an objective's goal, with the second order of its cost `terms`; start (nx,): of the motion."""
    plant, dt, given = about.plant, about.dt, (np.zeros(about.plant.nw), about.plant.nominal_parameters)
    goal = np.zeros(1), about.x_goal[None], about.u_goal[None]
    last = [m[0] for m in period_cost(terms.values(*goal, *given)[1], plant.nx, dt, effort)]
    period = HeldSteps(plant, dt, substeps, goal[0], *given).slopes(*goal[1:]).slope[0]
    slopes = None if about.drift.any() else plant.jacobians(about.x_goal, about.u_goal)[:2]
    names = [s.name for s in plant.states]
    return steady_law(period, *last, names=names, held=held, dt=dt, slopes=slopes, start=start - about.x_goal)


def steady_law(
    period: np.ndarray,
    Q: np.ndarray,
    R: np.ndarray,
    N: np.ndarray,
    *,
    names: Sequence[str],
    held: Sequence[str],
    dt: float,
    slopes: Sequence[np.ndarray] | None = None,
    start: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """K (nu, nx) and P (nx, nx) of dlqr for period = [A, B] (nx, nx + nu), in the states `held`; zero in the others.

    Where a held name is no state, an attitude that stands for a quaternion, all states are held. slopes: A (nx, nx) and
    B (nx, nu) of the continuous plant at an equilibrium, which tell what is conserved; start (nx,): where the motion
    begins, from the goal. See `riccati.steerable`.
    """
    nx = len(period)
    kept = [names.index(n) for n in held] if set(held) <= set(names) else list(range(nx))
    square = np.ix_(kept, kept)
    A, B, Q, N = period[square], period[kept, nx:], Q[square], N[kept]
    known, part = tuple(names[i] for i in kept), None
    if slopes is not None:
        off = None if start is None else start[kept]
        part = steerable(slopes[0][square], slopes[1][kept], Q, N, known, start=off)
        (A, B), (Q, N), known = part.system(A, B), part.weights(Q, N), part.names
    found = riccati.dlqr(A, B, Q, R, N, names=known, dt=dt)
    gain, cost = (found.K, found.P) if part is None else (part.gain(found.K), part.cost(found.P))
    K, P = np.zeros((B.shape[1], nx)), np.zeros((nx, nx))
    K[:, kept], P[square] = gain, cost
    return K, P


def period_weight(Q: np.ndarray, R: np.ndarray, N: np.ndarray) -> np.ndarray:
    """[[Q, N], [N', R]] (nx + nu, nx + nu)."""
    return np.block([[Q, N], [N.T, R]])

"""The cost of a control period to second order, and the steady regulator that goes with it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.controllers import riccati


def period_cost(J: np.ndarray, nx: int, dt: float, effort: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Q, R, N (B, ..) of one period from the residual's slopes J (B, nr, nx + nu)."""
    H = dt * J.transpose(0, 2, 1) @ J
    return H[:, :nx, :nx], effort * H[:, nx:, nx:], H[:, :nx, nx:]


def steady_law(
    period: np.ndarray,
    Q: np.ndarray,
    R: np.ndarray,
    N: np.ndarray,
    *,
    names: Sequence[str],
    held: Sequence[str],
    dt: float,
) -> tuple[np.ndarray, np.ndarray]:
    """K (nu, nx) and P (nx, nx) of dlqr for period = [A, B] (nx, nx + nu), in the states `held`; zero in the others.

    Where a held name is no state, an attitude that stands for a quaternion, all states are held.
    """
    nx = len(period)
    kept = [names.index(n) for n in held] if set(held) <= set(names) else list(range(nx))
    A, B = period[np.ix_(kept, kept)], period[kept, nx:]
    found = riccati.dlqr(A, B, Q[np.ix_(kept, kept)], R, N[kept], names=[names[i] for i in kept], dt=dt)
    K, P = np.zeros((B.shape[1], nx)), np.zeros((nx, nx))
    K[:, kept], P[np.ix_(kept, kept)] = found.K, found.P
    return K, P


def period_weight(Q: np.ndarray, R: np.ndarray, N: np.ndarray) -> np.ndarray:
    """[[Q, N], [N', R]] (nx + nu, nx + nu)."""
    return np.block([[Q, N], [N.T, R]])

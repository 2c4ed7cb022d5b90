"""The periodic regulator of systems that are drawn anew at every step: delays of a range, machines of a box.

min of the mean of [z; u]'W[z; u] + 2 g'[z; u] over time and draws, z+ = F_k [z; u]; F, W, g repeat after N steps and
are drawn among m.
P_k = H_zz - K'S K,  H = E[W + F'P_k+1 F],  S = H_uu,  K = S^-1 H_uz; the linear terms p, k beside it alike.

For m = 1 it is `dplqr`. It is stable in the mean square where draws are new at every step; a draw that stays is another
matter: `multipliers_of` looks at each.

Source   De Koning 1982, "Infinite horizon optimal control of linear discrete time systems with stochastic parameters",
         with coefficients that repeat
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import require_finite
from pliant.plants.core.errors import PliantError

from .checks import indefinite

Array = np.ndarray
SETTLED = 1e-12  # change of P and p over a period, relative
SWEEPS = 10_000
GROWN = 1e24  # of the first period's: past it nothing settles any more


class DrawnRegulator(NamedTuple):
    """u = -K_k z - k_k; cost to go in the mean, beside the mean cost, z'P_k z + 2 p_k'z."""

    K: Array  # (N, nu, nz)
    k: Array  # (N, nu)
    P: Array  # (N, nz, nz)
    p: Array  # (N, nz)
    S: Array  # (N, nu, nu): what v'S v an input v beside the law adds


def drawn_periodic(F: Any, W: Any, g: Any) -> DrawnRegulator:
    """F (m, N, nz, nz + nu), W (m, N, nz + nu, nz + nu) >= 0, g (m, N, nz + nu). PliantError where the equation has no
    solution, as for draws that no gain bears, or where an input costs nothing.

    Example
    -------
    >>> F = np.array([[0.9, 0.1], [1.2, 0.1]]).reshape(2, 1, 1, 2)
    >>> drawn_periodic(F, np.tile(np.eye(2), (2, 1, 1, 1)), np.zeros((2, 1, 2))).K.shape
    (1, 1, 1)
    """
    F = require_finite("F", F, (-1, -1, -1, -1))
    m, N, nz, both = F.shape
    if not (m and N and both > nz):
        raise ValueError(f"F has shape {F.shape}, must hold a draw, a step and an input")
    W, g = require_finite("W", W, (m, N, both, both)), require_finite("g", g, (m, N, both))
    if indefinite(W.reshape(m * N, both, both), 1e-9).any():
        raise ValueError("W has an eigenvalue that is not >= 0, must be >= 0")
    nu, W_mean, g_mean = both - nz, W.mean(axis=0), g.mean(axis=0)
    K, k, S = np.empty((N, nu, nz)), np.empty((N, nu)), np.empty((N, nu, nu))
    paid = W_mean.max(axis=0).diagonal()
    least = paid[paid > 0].min(initial=1.0)
    P, p, largest = (
        np.diag(np.where(paid > 0, paid, least)[:nz]),
        np.zeros(nz),
        None,
    )  # that every input costs something
    Ps, ps = np.empty((N, nz, nz)), np.empty((N, nz))
    for _ in range(SWEEPS):
        before = P, p
        for j in range(N - 1, -1, -1):
            H = W_mean[j] + (F[:, j].transpose(0, 2, 1) @ P @ F[:, j]).mean(axis=0)
            h = g_mean[j] + (F[:, j].transpose(0, 2, 1) @ p).mean(axis=0)
            S[j] = H[nz:, nz:]
            if not np.linalg.eigvalsh(S[j])[0] > 0:
                raise PliantError(f"drawn_periodic: step {j}: an input costs nothing, now and later")
            K[j], k[j] = np.linalg.solve(S[j], H[nz:, :nz]), np.linalg.solve(S[j], h[nz:])
            P, p = H[:nz, :nz] - H[:nz, nz:] @ K[j], h[:nz] - K[j].T @ h[nz:]
            P = (P + P.T) / 2
            Ps[j], ps[j] = P, p
        size = np.abs(P).max(initial=0.0)
        largest = GROWN * size if largest is None else largest
        if np.abs(P - before[0]).max(initial=0.0) <= SETTLED * size and np.abs(p - before[1]).max(
            initial=0.0
        ) <= SETTLED * max(np.abs(p).max(initial=0.0), 1e-300):
            return DrawnRegulator(K, k, Ps, ps, S)
        if not size <= largest:
            break
    raise PliantError("drawn_periodic: the Riccati equation in the mean has no solution: draw from less")


def multipliers_of(F: Any, K: Any) -> Array:
    """(m, nz) over the period, of u = -K_k z (N, nu, nz) on each of F (m, N, nz, nz + nu) that stays; largest first."""
    F = require_finite("F", F, (-1, -1, -1, -1))
    m, N, nz, both = F.shape
    K = require_finite("K", K, (N, both - nz, nz))
    around = np.tile(np.eye(nz), (m, 1, 1))
    for j in range(N):
        around = (F[:, j, :, :nz] - F[:, j, :, nz:] @ K[j]) @ around
    found = np.linalg.eigvals(around)
    return np.asarray(np.take_along_axis(found, np.argsort(-np.abs(found), axis=1, kind="stable"), axis=1))

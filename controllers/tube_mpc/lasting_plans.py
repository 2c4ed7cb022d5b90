"""Whether a plan that keeps its tightened limits always leaves one for the next sample, asked of linear programs.

The next plan starts as this one goes on, moved by what acted: that keeps all limits it shares with this one, by the
tightening's recursion. New is the last period, under K_f from the state xi that this plan ends its horizon in. So for
each limit of that period, over the xi whose limits past the horizon this plan keeps,

    max row xi <= limit - t_k[n]   ("Linear systems with state and control constraints", Gilbert and Tan 1991)

HiGHS tells the largest. Limits within the horizon, which say more of xi, are left out: false is not known, not shown.
"""

from __future__ import annotations

import numpy as np

from pliant.controllers.mpc.constraints import Limits, Step

from .error_bounds import Course, Tightening

Array = np.ndarray
SLACK = 1e-9  # of a limit's range


def lasts(
    course: Course,
    taken: Tightening,
    limits: Limits,
    c: Array,
    origin: tuple[Array, Array, Array],
    n: int,
    horizon: int,
) -> bool:
    """Of plans of n periods made at every time of `taken` (times, n + 2, ..), whose last stays."""
    from scipy.optimize import linprog

    for k in range(len(taken.u_high)):
        rows, low, high = past_horizon(course, taken, limits, c, origin, k, n, horizon)
        kept, least, most = (np.concatenate([*part[:-1], part[0][:0]]) for part in (rows, low, high))
        F = np.vstack([kept[np.isfinite(most)], -kept[np.isfinite(least)]])
        f = np.concatenate([most[np.isfinite(most)], -least[np.isfinite(least)]])
        for row, lowest, highest in zip(rows[-1], low[-1], high[-1]):
            size = highest - lowest if np.isfinite(highest - lowest) else 1.0
            for way, end in ((1.0, highest), (-1.0, -lowest)):
                if not np.isfinite(end):
                    continue
                found = linprog(-way * row, A_ub=F, b_ub=f, bounds=(None, None))
                none = found.status == 2  # no plan ends within its limits: none has to leave another
                if not none and (found.status != 0 or -found.fun > end + SLACK * size):
                    return False
    return True


def out_of_reach(
    step: Step,
    course: Course,
    taken: Tightening,
    limits: Limits,
    c: Array,
    origin: tuple[Array, Array, Array],
    k: int,
) -> tuple[Array, Array, Array, Array]:
    """Signals that no plan of time k moves, so that its program leaves them out: rows (m, nx) on the state less the
    origin's, lowest and highest (m,), place among the bounded signals (m,)."""
    nu, nb = len(limits.inputs), len(limits.bounded)
    names = step.names.reshape(-1, max(step.stride, 1))
    still = ~step.solver.M.any(axis=1).reshape(names.shape) & (names >= 0) & (names < nb)
    periods = np.flatnonzero(still.any(axis=1))
    found = [(j, int(i)) for j in periods for i in names[j][still[j]]]
    n = int(periods.max(initial=0))
    rows, low, high = past_horizon(course, taken, limits, c, origin, k, n, 0)
    ends = [(low[j][nu + i], high[j][nu + i]) for j, i in found]
    ends_at = np.array(ends, dtype=float).reshape(-1, 2)
    F = np.array([rows[j][nu + i] for j, i in found]).reshape(-1, course.A.shape[-1])
    return F, ends_at[:, 0], ends_at[:, 1], np.array([i for _, i in found], dtype=int)


def past_horizon(
    course: Course,
    taken: Tightening,
    limits: Limits,
    c: Array,
    origin: tuple[Array, Array, Array],
    k: int,
    n: int,
    horizon: int,
) -> tuple[list[Array], list[Array], list[Array]]:
    """Rows (m, nx) on xi, their lowest and highest (m,), of each period horizon .. n of the plan made at time k."""
    M, s = np.eye(course.A.shape[-1]), np.zeros(course.A.shape[-1])  # the state at that period is M xi + s
    rows, low, high = [], [], []

    def here(part: Array, at: int) -> Array:
        value: Array = part[min(at, len(part) - 1)]
        return value

    for j in range(horizon, n + 1):
        A, B, C, D, _, Kf = course.at(k + j)
        U = -Kf @ M, -Kf @ s - (0.0 if course.kf is None else here(course.kf, k + j))
        after = A @ M + B @ U[0], A @ s + B @ U[1] + here(c, k + j)
        next_C = course.at(k + j + 1)[2]
        own = [(*(part[i] for part in U), here(origin[1], k + j)[i]) for i in range(len(Kf))]
        ends = [(limits.low[i] + taken.u_low[k, j, i], limits.high[i] - taken.u_high[k, j, i]) for i in range(len(Kf))]
        for i in range(len(C)):
            at = j if course.direct[i] else j + 1
            if at == j:
                row = C[i] @ M + D[i] @ U[0], C[i] @ s + D[i] @ U[1]
            else:
                row = next_C[i] @ after[0], next_C[i] @ after[1]
            own.append((*row, here(origin[2], k + at)[i]))
            ends.append((limits.floor[i] + taken.z_low[k, at, i], limits.ceiling[i] - taken.z_high[k, at, i]))
        shift = np.array([one[1] + one[2] for one in own])
        rows.append(np.array([one[0] for one in own]))
        low.append(np.array([one[0] for one in ends]) - shift)
        high.append(np.array([one[1] for one in ends]) - shift)
        M, s = after
    return rows, low, high

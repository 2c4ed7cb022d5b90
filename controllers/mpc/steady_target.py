"""The steady state that a predictive controller aims at: least tracking error first, then least cost.

    (A - I) x + B u + B_d d = 0,   e = H x + D u + H_d d - r,   low <= u <= high

1. without limits     e = 0, and of such (x, u) the one of least cost [x; u]'W [x; u]
2. it passes a limit  e = 0 within the limits at least cost, where that is possible
3. it is not          the least sum of (e_i / range_i)^2 that the limits allow, then the least cost that leaves e there

range_i is half of what the limits let signal i reach, so that the answer does not depend on units and nothing is traded
against the cost: a weight on e large enough for one plant is too small for the next. The two levels are two quadratic
programs ("Linear MPC: targets and offset", Rao and Rawlings 1999, state the target as such a pair). The first has many
solutions where inputs are redundant; it is solved by proximal steps (Rockafellar 1976), each a least-distance problem.
"""

from __future__ import annotations

from typing import final

import numpy as np
import scipy.linalg as sla

from pliant.controllers.solvers.daqp_model import INFINITE
from pliant.controllers.solvers.least_distance_qp import LeastDistance
from pliant.plants.core.errors import InfeasibleError
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray
INFLUENCE = 1e-9  # least singular value of the equilibrated target equations, against the largest
PROXIMAL = 1e-6  # weight of a proximal step, against the least squared singular value of the tracking error
STEPS = 20  # of them at most; each divides what is left by a million
UNSEEN = 1e-12  # share of the largest cost that directions without any cost are given


@final
class Target(OwnsArrays):
    """Steady (x, u), deviations from the model's point, for a disturbance d and goals r of the tracked signals.

    Where no steady state is within the limits of the inputs, that of step 1, whose inputs then saturate.
    """

    def __init__(
        self,
        A: Array,
        B: Array,
        Bd: Array,
        tracked: tuple[Array, Array, Array],
        weight: Array,
        low: Array,
        high: Array,
    ) -> None:
        """weight (nx + nu, nx + nu) of [x; u]; low, high (nu,) of du; tracked = (H, D, Hd)."""
        nx, nu = B.shape
        H, D, Hd = tracked
        rest, wanted = np.hstack([A - np.eye(nx), B]), np.hstack([H, D])
        E = np.vstack([rest, wanted])
        rows, columns = equilibrium_scales(E)
        even, columns = E / rows[:, None] / columns, 1 / columns  # even (s / columns) = right-hand side / rows
        sigma = np.linalg.svd(even, compute_uv=False)
        if len(E) > nx + nu or sigma[-1] <= INFLUENCE * sigma[0]:
            raise InfeasibleError(
                f"no steady inputs bring {len(H)} tracked signals to any values: track at most as many signals as "
                "there are inputs, and only such as can be held"
            )
        self._nx, self._low, self._high = nx, low, high
        self._unit = np.where(np.isfinite(high - low) & (high > low), (high - low) / 2, columns[nx:])  # of each input
        root = semidefinite_root(weight).T
        onto = np.block([[-Bd, np.zeros((nx, len(H)))], [-Hd, np.eye(len(H))]])
        base = columns[:, None] * np.linalg.pinv(even) / rows @ onto
        self._spare = _Spare(columns[:, None] * sla.null_space(even), root, nx, self._unit)
        self._map = np.ascontiguousarray(np.column_stack([self._spare.cheapest(s) for s in base.T]))  # of [d; r]
        self._known, self._s = np.empty(onto.shape[1]), np.empty(nx + nu)
        self._nearest: _Nearest | None = None
        if np.isfinite(low).any() or np.isfinite(high).any():
            own = even[:nx]
            held = columns[:, None] * np.linalg.pinv(own) / rows[:nx] @ -Bd
            free = columns[:, None] * sla.null_space(own)
            range_ = reachable(wanted @ free, free[nx:], low, high, root @ free)
            free = even_directions(free, wanted / range_[:, None], nx, self._unit)
            start = np.hstack([held, np.zeros((nx + nu, len(H)))])
            error = wanted @ start + np.hstack([Hd, -np.eye(len(H))])
            self._nearest = _Nearest(start, free, error / range_[:, None], wanted / range_[:, None], nx, self._unit)
        self.limited = False  # whether the limits keep the inputs of step 1
        self.missed = False  # whether they keep tracked signals from their goals

    def __call__(self, d: Array, r: Array) -> Array:
        """[x; u] (nx + nu,), overwritten by the next call."""
        self._known[: len(d)], self._known[len(d) :] = d, r
        s = np.dot(self._map, self._known, out=self._s)
        u = s[self._nx :]
        self.limited = self._nearest is not None and bool((u < self._low).any() or (u > self._high).any())
        self.missed = False
        if self._nearest is None or not self.limited:
            return s
        found = self._spare.within(s, self._low, self._high)
        if found is None:
            self.missed = True
            near = self._nearest(self._known, self._low, self._high)
            if near is None:
                return s
            held = near[self._nx :]
            low, high = np.minimum(self._low, held), np.maximum(self._high, held)
            found = self._spare.within(self._spare.cheapest(near), low, high)
            found = near if found is None else found
        s[:] = found
        return s


@final
class _Spare(OwnsArrays):
    """Directions Z (n, nz) that no tracked signal sees and in which the machine stays at rest: where cost decides."""

    def __init__(self, Z: Array, root: Array, nx: int, unit: Array) -> None:
        """root'root = W."""
        seen = root @ Z
        size = np.linalg.norm(seen) if seen.size else 0.0
        kept = np.vstack([seen, np.sqrt(UNSEEN) * size * np.eye(Z.shape[1])]) if size else np.eye(Z.shape[1])
        T = np.linalg.qr(kept, mode="r")
        self._reach = sla.solve_triangular(T, Z.T, trans="T").T if Z.shape[1] else Z  # Z T^-1
        self._root, self._nx, self._unit = root, nx, unit
        self._solver = LeastDistance(self._reach[nx:] / unit[:, None], np.zeros(len(unit), dtype=bool), 0.0)

    def cheapest(self, s: Array) -> Array:
        """s (n,) moved along Z to the least cost without limits."""
        seen = self._root @ self._reach
        return s - self._reach @ (seen.T @ (self._root @ s))

    def within(self, s: Array, low: Array, high: Array) -> Array | None:
        """The cheapest of s + Z v within the limits, from the cheapest without; None where there is none."""
        if not self._reach.shape[1]:
            u = s[self._nx :]
            return s if (u >= low).all() and (u <= high).all() else None
        z = self._solver.solve(*_bounds(low, high, s[self._nx :], self._unit))
        return None if z is None else s + self._reach @ z


@final
class _Nearest(OwnsArrays):
    """The steady state of least tracking error within the limits of the inputs; one of them where there are many."""

    def __init__(self, start: Array, free: Array, error: Array, wanted: Array, nx: int, unit: Array) -> None:
        """s = start known + free y; the error, in its ranges, error known + wanted s' with s' = free y."""
        U, sigma, V = np.linalg.svd(wanted @ free)
        step = PROXIMAL * sigma[-1] ** 2 if len(V) > len(sigma) else 0.0
        each = np.sqrt(np.concatenate([sigma**2 + step, np.full(len(V) - len(sigma), step)]))
        self._reach, self._each = free @ V.T / each, each  # y = V'(z / each)
        self._start, self._error = start, U.T @ error
        self._sigma, self._step, self._nx, self._unit = sigma, step, nx, unit
        self._solver = LeastDistance(self._reach[nx:] / unit[:, None], np.zeros(len(unit), dtype=bool), 0.0)

    def __call__(self, known: Array, low: Array, high: Array) -> Array | None:
        start, error = self._start @ known, self._error @ known
        z, m = np.zeros(len(self._each)), len(self._sigma)
        free = self._step / self._each**2
        for k in range(STEPS if self._step else 1):  # min |sigma y + error|^2 + step |y - last|^2, z = each y
            centre = free * z
            centre[:m] -= self._sigma * error / self._each[:m]
            s = start + self._reach @ centre
            found = self._solver.solve(*_bounds(low, high, s[self._nx :], self._unit))
            if found is None:
                return None
            before, z = z, centre + found
            moved = self._sigma / self._each[:m] * (z - before)[:m]
            if k and np.abs(moved).max() <= 1e-14 * (1.0 + np.abs(error).max()):
                break
        return np.asarray(start + self._reach @ z)


def _bounds(low: Array, high: Array, u: Array, unit: Array) -> tuple[Array, Array]:
    """What is left to the limits from u, in units of the inputs."""
    return np.maximum((low - u) / unit, -INFINITE), np.minimum((high - u) / unit, INFINITE)


def even_directions(free: Array, wanted: Array, nx: int, unit: Array) -> Array:
    """Another base of free (nx + nu, k): a unit of it moves inputs by about a unit, or signals by about a range."""
    seen = np.vstack([free[nx:] / unit[:, None], wanted @ free])
    _, size, V = np.linalg.svd(seen)
    size = np.concatenate([size, np.zeros(len(V) - len(size))])
    return np.asarray(free @ V.T / np.where(size > INFLUENCE * size.max(initial=0.0), size, 1.0))


def equilibrium_scales(E: Array) -> tuple[Array, Array]:
    """Scales of rows and columns of E (m, n) that bring its largest entries in each near one: no unit is left."""
    rows, columns = np.ones(len(E)), np.ones(E.shape[1])
    for _ in range(8):
        size = np.abs(E) / rows[:, None] / columns
        rows *= np.sqrt(np.where(size.any(axis=1), size.max(axis=1, initial=0.0), 1.0))
        columns *= np.sqrt(np.where(size.any(axis=0), size.max(axis=0, initial=0.0), 1.0))
    return rows, columns


def reachable(wanted: Array, inputs: Array, low: Array, high: Array, seen: Array) -> Array:
    """Half of the range of each signal wanted y under low <= inputs y <= high, by two linear programs each.

    Where that has no end, what one unit of cost |seen y|^2 moves the signal by, scaled as the ranges of the others are.
    """
    from scipy.optimize import linprog

    unit = np.where(np.isfinite(high - low) & (high > low), high - low, 1.0)
    A, b = np.vstack([inputs, -inputs]) / np.tile(unit, 2)[:, None], np.concatenate([high, -low]) / np.tile(unit, 2)
    finite = np.isfinite(b)
    range_ = np.full(len(wanted), np.inf)
    for i, row in enumerate(wanted):
        size = np.abs(row).max(initial=0.0) or 1.0
        ends = [linprog(way * row / size, A_ub=A[finite], b_ub=b[finite], bounds=(None, None)) for way in (1, -1)]
        if all(end.status == 0 for end in ends):
            range_[i] = -size * sum(end.fun for end in ends) / 2
    cost = seen.T @ seen + UNSEEN * max(float(np.square(seen).sum()), np.finfo(float).tiny) * np.eye(seen.shape[1])
    moves = np.sqrt(np.einsum("ij,ji->i", wanted, np.linalg.solve(cost, wanted.T)))
    known = np.isfinite(range_) & (range_ > 0)
    factor = float(np.median(range_[known] / moves[known])) if known.any() else 1.0
    return np.where(known, range_, factor * moves)

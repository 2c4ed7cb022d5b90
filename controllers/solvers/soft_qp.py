"""A quadratic program with limits on its variables and soft rows, solved again and again, by DAQP's active-set method
(Arnstrom, Bemporad, Axehill, "A dual active-set solver for embedded quadratic programming using recursive LDL'
updates", 2022).

min 1/2 d'H d + f'd + w sum of s,  lowest <= d <= highest,  low - s <= Z d <= high + s,  s >= 0

A penalty linear in s is exact: no row is violated that could hold, where w is above every row's multiplier. Most of
the time no row binds; so the program without them is solved first, and with them only where its solution breaks one.
That solution is the same. Rows that nearly bound the last time are taken from the start.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, final

import numpy as np

if TYPE_CHECKING:
    import daqp

Array = np.ndarray
SOFT = 8  # DAQP's mark of a row that may be violated
SOLVED = (1, 2)  # DAQP: optimal, optimal with soft rows violated
NEAR = 0.2  # of a bound, in the rows' unit: they are best scaled to bounds about 1
CURVATURE = 1e-3  # weight of half the square of a violation, which DAQP needs, over that of the violation
WORDS = {
    -1: "infeasible",
    -2: "the active set cycles",
    -3: "unbounded",
    -4: "iteration limit",
    -5: "not convex",
    -6: "too many equalities",
}


@final
class SoftProgram:
    """n variables, m soft rows. `prepare` takes H and Z, `solve` the rest; both reuse DAQP's workspace."""

    def __init__(self, n: int, m: int, *, penalty: float, iteration_limit: int = 1000, tolerance: float = 1e-9) -> None:
        self.n, self.m, self.penalty = n, m, penalty
        self._settings = {"iter_limit": iteration_limit, "primal_tol": tolerance}
        self._models: dict[int, daqp.Model] = {}
        self._current: set[int] = set()  # programs that have the last H and Z
        self._high, self._low = np.zeros(n + m), np.zeros(n + m)
        self._z = np.zeros(m)
        self._sense = np.zeros(n + m, dtype=np.int32)
        self._sense[n:] = SOFT
        self.near = False  # whether the last solution came near a row
        self.status, self.iterations, self.violation = 1, 0, 0.0
        self.limited = False  # whether a bound or row is active in the last solution
        self.multipliers = np.zeros(m)  # of the rows in the last solution, positive at upper bounds

    def prepare(self, H: Array, Z: Array) -> bool:
        """H (n, n) symmetric and positive definite, Z (m, n); kept by reference until the next `prepare`.

        False where H is not definite to rounding: there will be no solution.
        """
        self.H, self.Z = H, Z
        self._current.clear()
        return self._update(self.m if self.near else 0)

    def forget(self) -> None:
        """Start again from no active set."""
        self._models.clear()
        self._current.clear()
        self.near = False

    def solve(self, f: Array, lowest: Array, highest: Array, low: Array, high: Array) -> Array | None:
        """d (n,), or None with `status` where there is no solution. `violation` is the largest s."""
        n = self.n
        self._low[:n], self._high[:n], self._low[n:], self._high[n:] = lowest, highest, low, high
        self.iterations, self.violation = 0, 0.0
        whole = self.near or not self.m
        d = self._solve(self.m if self.near else 0, f)
        if d is None or not self.m:
            return d
        out = self._broken(d)
        if out > 0 and not whole:
            d = self._solve(self.m, f)
            if d is None:
                return None
            out = self._broken(d)
        self.violation = max(out, 0.0)
        return d

    @property
    def excess(self) -> Array:
        """(m,) what the rows of the last solution are outside by."""
        return np.maximum(np.maximum(self._z - self._high[self.n :], self._low[self.n :] - self._z), 0.0)

    def _broken(self, d: Array) -> float:
        """How far the worst row is outside; sets `near` where one is within NEAR of a bound."""
        np.matmul(self.Z, d, out=self._z)
        low, high = self._low[self.n :], self._high[self.n :]
        out = float(max((self._z - high).max(), (low - self._z).max()))
        self.near = out > -NEAR
        return out

    def _solve(self, rows: int, f: Array) -> Array | None:
        if rows not in self._current and not self._update(rows):
            return None
        size, model = self.n + rows, self._models[rows]
        self.status = model.update(f=f, bupper=self._high[:size], blower=self._low[:size])
        if self.status < 0:
            return None
        d, _, self.status, info = model.solve()
        self.iterations += info["iterations"]
        if self.status not in SOLVED and model.update(sense=self._sense[:size]) >= 0:  # again, from no active set
            d, _, self.status, info = model.solve()
            self.iterations += info["iterations"]
        if self.status not in SOLVED:
            return None
        self.limited = bool(info["lam"].any())
        self.multipliers[:] = info["lam"][self.n :] if rows else 0.0
        return d

    def _update(self, rows: int) -> bool:
        Z = self.Z[:rows]
        model = self._models.get(rows)
        if model is None:
            model = self._models[rows] = self._new(rows)
        self.status = model.update(H=self.H, A=Z) if rows else model.update(H=self.H)
        if self.status >= 0:
            self._current.add(rows)
        return self.status >= 0

    def _new(self, rows: int) -> daqp.Model:
        import daqp

        n = self.n
        model = daqp.Model()
        ones = np.ones(n + rows)
        model.settings = self._settings
        model.setup(np.eye(n), np.zeros(n), np.eye(rows, n), ones, -ones, self._sense[: n + rows].copy())
        w = np.full(n + rows, self.penalty)
        rho = 1 / (CURVATURE * w)
        model.soft_weights(rho, rho, w, w)
        return model

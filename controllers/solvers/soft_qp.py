"""A quadratic program with limits on its variables and soft rows, solved again and again (see daqp_model.py).

min 1/2 d'H d + f'd + w sum of s,  lowest <= d <= highest,  low - s <= Z d <= high + s,  s >= 0

A penalty linear in s is exact: no row is violated that could hold, where w is above every row's multiplier. Most of
the time no row binds; so the program without them is solved first, and with them only where its solution breaks one.
That solution is the same. Rows that nearly bound the last time are taken from the start.
"""

from __future__ import annotations

from typing import final

import numpy as np

from .daqp_model import SOFT, DaqpModel

Array = np.ndarray
NEAR = 0.2  # of a bound, in the rows' unit: they are best scaled to bounds about 1


@final
class SoftProgram:
    """n variables, m soft rows. `prepare` takes H and Z, `solve` the rest; both reuse DAQP's workspace."""

    def __init__(self, n: int, m: int, *, penalty: float, iteration_limit: int = 1000, tolerance: float = 1e-9) -> None:
        self.n, self.m, self.penalty = n, m, penalty
        self._settings = iteration_limit, tolerance
        self._models: dict[int, DaqpModel] = {}
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

    def settle(self) -> None:
        """Nothing binds: what a caller that found the solution without limits and rows has to say."""
        self.status, self.iterations, self.violation, self.limited = 1, 0, 0.0, False
        self.multipliers[:] = 0.0

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
        d = model.solve() if model.update(f=f, bupper=self._high[:size], blower=self._low[:size]) else None
        self.status = model.flag
        self.iterations += model.iterations
        if d is None:
            return None
        self.limited = bool(model.multipliers.any())
        self.multipliers[:] = model.multipliers[self.n :] if rows else 0.0
        return d

    def _update(self, rows: int) -> bool:
        Z = self.Z[:rows]
        model = self._models.get(rows)
        if model is None:
            model = self._models[rows] = self._new(rows)
        taken = model.update(H=self.H, A=Z) if rows else model.update(H=self.H)
        self.status = model.flag
        if taken:
            self._current.add(rows)
        return taken

    def _new(self, rows: int) -> DaqpModel:
        n, (limit, tolerance) = self.n, self._settings
        sense = self._sense[: n + rows].copy()
        model = DaqpModel(
            np.eye(n), np.zeros(n), np.eye(rows, n), sense, far=1.0, tolerance=tolerance, iteration_limit=limit
        )
        model.price(self.penalty)
        return model

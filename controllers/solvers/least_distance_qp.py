"""min |z|^2 + penalty sum_i s_i over z, s >= 0 with lower - s <= M z <= upper + s, s_i = 0 where row i is hard.

A least-distance problem, which is what a dual active-set method solves inside: "A Dual Active-Set Solver for Embedded
Quadratic Programming Using Recursive LDL' Updates" (Arnstrom, Bemporad, Axehill 2022), the solver DAQP. M is handed
over and factorised once; a solve takes new bounds only, and starts from the active set, and its factors, of the last.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

INFINITE = 1e30  # a bound that DAQP takes for none
TOLERANCE = 1e-9  # largest violation of a row that passes for none, in the row's unit
SOFT, ACTIVE, AT_LOWER = 8, 1, 2  # DAQP's marks of a row
VIOLATED = 2  # DAQP's exit flag: optimal, a soft row is violated
CURVATURE = 1e-3  # quadratic part of the penalty at a violation of one, relative to the linear part


@final
class LeastDistance:
    """Built once for M (m, nz), soft (m,) bool and penalty >= 0, in cost per unit of a soft row."""

    def __init__(self, M: Any, soft: Any, penalty: float) -> None:
        self.M = np.array(M, dtype=float, order="C")
        self.soft = np.array(soft, dtype=bool)
        self.penalty = float(penalty)
        self._build()

    def _build(self) -> None:
        import daqp

        m, nz = self.M.shape
        self._sense = np.where(self.soft, SOFT, 0).astype(np.intc)
        self._warm = self._sense.copy()
        self._solver = daqp.Model()
        self._solver.settings = {"primal_tol": TOLERANCE, "iter_limit": 20 * (m + nz) + 100}
        far = np.full(m, INFINITE)
        flag, _ = self._solver.setup(np.eye(nz), np.zeros(nz), self.M, far, -far, self._sense.copy())
        if flag < 0:
            raise ValueError(f"LeastDistance: DAQP refuses M {self.M.shape} with flag {flag}")
        if self.soft.any():
            w = np.full(m, max(self.penalty, 1e-12) / 2)  # DAQP halves |z|^2
            rho = 1 / (CURVATURE * w)
            self._solver.soft_weights(rho, rho, w, w)
        self.flag = 0
        self.multipliers = np.zeros(m)  # of the last solve, positive at upper bounds, for the cost |z|^2 / 2

    def solve(self, lower: np.ndarray, upper: np.ndarray, multipliers: np.ndarray | None = None) -> np.ndarray | None:
        """z (nz,), None where there is none or it is not found; `flag` and `violated` say more.

        lower, upper (m,), C-ordered, at most 1e30; they are read during the call only. `multipliers` (m,) of a
        neighbouring problem give the active set to start from instead of the last one.
        """
        solver = self._solver
        if multipliers is None:
            self.flag = solver.update(bupper=upper, blower=lower)
        else:
            self._mark(multipliers)
            self.flag = solver.update(bupper=upper, blower=lower, sense=self._warm)
        if self.flag >= 0:
            z, _, self.flag, info = solver.solve()
            if self.flag > 0:
                self.multipliers = info["lam"]
                return z
        if solver.update(bupper=upper, blower=lower, sense=self._sense) >= 0:  # once more, from no active set
            z, _, self.flag, info = solver.solve()
            if self.flag > 0:
                self.multipliers = info["lam"]
                return z
        self.forget()
        return None

    @property
    def violated(self) -> bool:
        """Whether the last solve violates a soft row."""
        return self.flag == VIOLATED

    def forget(self) -> None:
        """Start the next solve from no active set."""
        if len(self._sense):
            self._solver.update(sense=self._sense)

    def _mark(self, multipliers: np.ndarray) -> None:
        warm = self._warm
        np.copyto(warm, self._sense)
        warm[multipliers > 0] |= ACTIVE
        warm[multipliers < 0] |= ACTIVE | AT_LOWER

    def __getstate__(self) -> dict[str, Any]:
        return {"M": self.M, "soft": self.soft, "penalty": self.penalty}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._build()

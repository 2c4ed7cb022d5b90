"""min |z|^2 + penalty sum_i s_i over z, s >= 0 with lower - s <= M z <= upper + s, s_i = 0 where row i is hard.

A least-distance problem, which is what a dual active-set method solves inside (see daqp_model.py). M is handed over and
factorised once; a solve takes new bounds only, and starts from the active set, and its factors, of the last.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pliant.plants.core.signals import owned

from .daqp_model import ACTIVE, AT_LOWER, INFINITE, SOFT, DaqpModel

KEPT = 1e-6  # in a hard row's unit: past it a solution is none
TOLERANCE = 1e-9  # largest violation of a row that passes for none, in the row's unit


@final
class LeastDistance:
    """Built once for M (m, nz), soft (m,) bool and penalty >= 0, in cost per unit of a soft row."""

    def __init__(self, M: Any, soft: Any, penalty: float) -> None:
        self.M = np.array(M, dtype=float, order="C")
        self.soft = np.array(soft, dtype=bool)
        self.penalty = float(penalty)
        self._build()

    def _build(self) -> None:
        m, nz = self.M.shape
        self._hard, self._some_soft = ~self.soft, bool(self.soft.any())
        self._any_hard = bool(self._hard.any())
        sense = np.where(self.soft, SOFT, 0).astype(np.intc)
        self._warm = sense.copy()
        limit = 20 * (m + nz) + 100
        self._model = DaqpModel(
            np.eye(nz), np.zeros(nz), self.M, sense, far=INFINITE, tolerance=TOLERANCE, iteration_limit=limit
        )
        if self._model.flag < 0:
            raise ValueError(f"LeastDistance: DAQP refuses M {self.M.shape} with flag {self._model.flag}")
        if self.soft.any():
            self._model.price(max(self.penalty, 1e-12) / 2)  # DAQP halves |z|^2

    def solve(self, lower: np.ndarray, upper: np.ndarray, multipliers: np.ndarray | None = None) -> np.ndarray | None:
        """z (nz,), None where there is none or it is not found; `flag` and `violated` say more.

        lower, upper (m,), C-ordered, at most 1e30; they are read during the call only. `multipliers` (m,) of a
        neighbouring problem give the active set to start from instead of the last one.
        """
        model = self._model
        if multipliers is None:
            taken = model.update(bupper=upper, blower=lower)
        else:
            self._mark(multipliers)
            taken = model.update(bupper=upper, blower=lower, sense=self._warm)
        if taken or model.update(bupper=upper, blower=lower, sense=model.sense):
            z = model.solve()
            if z is not None and (z := self._kept(z, lower, upper)) is not None:
                return z
        model.forget()
        return None

    def _kept(self, z: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray | None:
        """z where it keeps the hard rows; else the least z on the rows that are active, where that does.

        DAQP squares the condition of those rows, which is large where a plant grows far over a horizon.
        """
        if self._beyond(z, lower, upper) <= KEPT:
            return z
        if self.violated:
            return None
        sign = self.multipliers
        active = sign != 0
        z = np.linalg.lstsq(self.M[active], np.where(sign > 0, upper, lower)[active], rcond=None)[0]
        return z if self._beyond(z, lower, upper) <= KEPT else None

    def _beyond(self, z: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> float:
        """How far z is past the worst hard row."""
        if not self._any_hard:
            return 0.0
        rows = self.M.dot(z)
        worst = np.maximum(rows - upper, lower - rows)
        return float(worst[self._hard].max() if self._some_soft else worst.max())

    @property
    def flag(self) -> int:
        """DAQP's, of the last solve."""
        return self._model.flag

    @property
    def multipliers(self) -> np.ndarray:
        """(m,) of the last solution, positive at upper bounds, for the cost |z|^2 / 2."""
        return self._model.multipliers

    @property
    def violated(self) -> bool:
        """Whether the last solve violates a soft row."""
        return self._model.violated

    def forget(self) -> None:
        """Start the next solve from no active set."""
        self._model.forget()

    def _mark(self, multipliers: np.ndarray) -> None:
        warm = self._warm
        np.copyto(warm, self._model.sense)
        warm[multipliers > 0] |= ACTIVE
        warm[multipliers < 0] |= ACTIVE | AT_LOWER

    def __getstate__(self) -> dict[str, Any]:
        return {"M": self.M, "soft": self.soft, "penalty": self.penalty}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(owned(state))
        self._build()

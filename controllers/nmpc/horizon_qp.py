"""The quadratic program about a plan: changes of its inputs within the limits, its bounded signals softly in theirs."""

from __future__ import annotations

from typing import final

import numpy as np

from pliant.controllers.solvers.daqp_model import CURVATURE, WORDS
from pliant.controllers.solvers.soft_qp import SoftProgram

from .horizon import Horizon
from .stage_recursion import StageRecursion

Array = np.ndarray


@final
class HorizonProgram:
    """Around `plan`. Rows of bounded signals are in half the bound's range, their `penalty` is of the plan's cost."""

    def __init__(self, plan: Horizon, penalty: float, iteration_limit: int) -> None:
        self.plan, self.penalty = plan, penalty
        objective, N = plan.objective, plan.N
        self.lowest, self.highest = objective.limits
        span = self.highest - self.lowest
        self.input_scale = np.where(np.isfinite(span), span, 2.0) / 2
        _, low, high = objective.bounded_expression
        self.half = np.where(np.isfinite(high - low), (high - low) / 2, 1.0)
        self._scale = np.tile(1 / self.half, N - 1)
        self.low, self.high = np.tile(low, N - 1) * self._scale, np.tile(high, N - 1) * self._scale
        # the program's cost is half the plan's
        self.solver = SoftProgram(plan.u.size, len(self._scale), penalty=penalty / 2, iteration_limit=iteration_limit)
        self._rows = np.zeros((len(self._scale), plan.u.size))
        self.sound, self.why = False, ""
        self._whole = False  # whether the solver has the program of the last plan

    def linearize(self, *, close: bool = False) -> bool:
        """All that does not wait for a measurement; `close` as in Horizon. False where the plan is no motion, or one so
        wild that its program has no definite cost.

        A long horizon is condensed for limits and bounds only where one bound in the last solution.
        """
        plan, self._whole = self.plan, False
        self.sound = plan.linearize(close=close)
        if self.sound and (plan.recursion is None or self.solver.limited):
            self.sound = self._prepare()
        self._room = (self.lowest - plan.u).ravel(), (self.highest - plan.u).ravel()
        return self.sound

    def solve(self, e: Array) -> Array | None:
        """Changes d (N nu,) of the inputs for dx_0 = e (nx,), None where there is none; `why` says why."""
        self.why = ""
        if not self.sound:
            self.why = "the plan is no motion that can be linearised"
            return None
        if self.plan.recursion is not None:
            if (free := self._free(self.plan.recursion, e)) is not None:
                return free
            if not self._whole and not self._prepare():
                self.why = WORDS[-5]
                return None
        ready = self.plan.condensed
        z = self._scale * (ready.z0 + ready.Ze @ e)
        d = self.solver.solve(ready.F @ e + ready.f0, *self._room, self.low - z, self.high - z)
        if d is None:
            self.why = WORDS.get(self.solver.status, f"flag {self.solver.status}")
        return d

    def _prepare(self) -> bool:
        """The program with its limits and bounds; False where it is not finite, or not definite."""
        ready = self.plan.condensed
        if self.plan.recursion is not None:
            with np.errstate(over="ignore", invalid="ignore"):
                ready.form()
                if not np.isfinite(ready.S.sum() + ready.Zd.sum()):
                    return False
        np.multiply(ready.Zd, self._scale[:, None], out=self._rows)
        self._whole = self.solver.prepare(ready.H, self._rows)
        return self._whole

    def _free(self, recursion: StageRecursion, e: Array) -> Array | None:
        """The solution where neither a limit nor a bound binds: the whole program then has the same. Else None."""
        dx, d = recursion.solve(e)
        lowest, highest = self._room
        if not ((lowest <= d) & (d <= highest)).all():
            return None
        z = self._scale * self.plan.condensed.signals(dx, d) if len(self._scale) else self._scale
        if not ((self.low <= z) & (z <= self.high)).all():
            return None
        self.solver.settle()
        return d

    @property
    def excess(self) -> Array:
        """(nb,) what the bounded signals of the last solution are outside by, at their worst node [their unit]."""
        return self.solver.excess.reshape(self.plan.N - 1, len(self.half)).max(axis=0, initial=0.0) * self.half

    def charge(self, z: Array) -> float:
        """The cost of bounded signals z ((N-1) nb,) outside their bounds."""
        z = self._scale * z
        s = np.maximum(np.maximum(z - self.high, self.low - z), 0.0)
        return float(self.penalty * (s.sum() + CURVATURE * (s @ s) / 2))

    def multipliers(self) -> Array:
        """(N-1, nb) of the bounded signals in the last solution: the change of the plan's cost by one of the bound."""
        return (2 * self.solver.multipliers * self._scale).reshape(self.plan.N - 1, len(self.half))

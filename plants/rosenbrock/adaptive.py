"""Adaptive linearly implicit integration: Rodas5P with the plant's exact Jacobian and dense output at the asked times.

L-stable: modes that are too fast to be resolved within the tolerance are damped, and cost nothing once they are at
rest. Steps end where a held input jumps and at the end of the motion; what lies between comes from the stages (Hairer
and Wanner, "Solving Ordinary Differential Equations II", IV.7).
In native code where that is at hand or pays, with the same numbers to rounding.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.motions import adaptive_steps
from pliant.plants.motions.adaptive_steps import GROW, PAUSED, SAFETY, SHRINK, SMALLEST_STEP
from pliant.plants.motions.motion_library import A_CALL, LONG, _place
from pliant.plants.motions.time_limit import check_time, steps_of_a_call
from pliant.plants.toolchain import shared_library

from .plant_functions import slopes
from .tableaux import RosenbrockTableau, rodas5p

Array = np.ndarray
METHOD = "rodas5p"
LAW_AT = (0, 1, 2, 3, 5)  # stages through whose inputs the polynomial goes that gives du/dt of a function of time


def next_jumps(u: Array) -> Array:
    """The row (nt - 1,) at which inputs u (nt, nu), held over each period, change next; the last where they do not."""
    last = len(u) - 1
    changes = np.append(np.flatnonzero((u[1:last] != u[: last - 1]).any(axis=1)) + 1, last)
    return changes[np.searchsorted(changes, np.arange(last), side="right")]


class AdaptiveLibrary:
    """`adaptive` of adaptive_source.py in a loaded library."""

    def __init__(self, path: Path) -> None:
        (function,) = shared_library.functions(path, "adaptive")
        count, pointer = ctypes.c_long, ctypes.c_void_p
        function.argtypes = [count, count, *[pointer] * 9]
        function.restype = count
        self.adaptive: Any = function


@lru_cache(maxsize=4)
def input_slope(tableau: RosenbrockTableau) -> Array:
    """Weights (s,) with which the inputs at the stages give h du/dt at the step's start."""
    at = tableau.alpha[list(LAW_AT)]
    first = np.zeros(len(at))
    first[1] = 1.0
    weights = np.zeros(len(tableau.alpha))
    weights[list(LAW_AT)] = np.linalg.solve(np.vander(at, increasing=True).T, first)
    return weights


class RosenbrockMotion:
    """One motion of a plant at the times t (nt,) [s]: the `state` (nx,) at `time`, at or past `row`, the last there is.

    u (nt, nu): rows held over each period, or law(times) (times * nu,). ends (nt - 1,): the row at whose time the input
    of each period jumps next. `steps` counts those that were tried.
    """

    def __init__(
        self,
        plant: PlantLike,
        t: Array,
        u: Array,
        law: Callable[[Array], Array] | None,
        w: Array,
        p: Array,
        *,
        rtol: float,
        atol: float,
        ends: Array,
    ) -> None:
        self.plant, self.t, self.u, self.law, self.w, self.p = plant, t, u, law, w, p
        self.rtol, self.atol, self.ends = rtol, atol, np.ascontiguousarray(ends, dtype=LONG)
        self.tableau = rodas5p()
        self.steps = self.row = 0
        self.begun = False  # whether a step has been taken since the input jumped last
        self.time = self.step = self.trial = 0.0
        self.state = np.zeros(plant.nx)

    def begin(self, time: float, state: Array, step: float) -> None:
        """Where it starts, with the first step [s] to be tried."""
        self.time, self.state, self.step = time, state.copy(), step

    def march(self, x: Array, last: int, report: Callable[[float], None] | None = None) -> None:
        """Fill the next rows of x (nt, nx) until `last` is there; more may come with it."""
        fresh = False
        while (k := self.row) < last:
            jump = int(self.ends[k])
            end = float(self.t[jump])
            if not self.begun:
                self.step = min(self.step, end - self.time)
            self.begun = True
            ends = self.time + self.step >= end * (1 - 1e-15) or end - self.time - self.step < 1e-3 * self.step
            self.trial = h = end - self.time if ends else self.step
            self.steps += 1
            check_time(self.time)
            if self.steps > adaptive_steps.most_steps():
                raise adaptive_steps.too_many_steps(self.time, self.state, h, METHOD)
            inputs = self._inputs(k, h, self.tableau.alpha)
            if not fresh:
                self._linearise(inputs[0])
                fresh = True
            after, stages = self._stages(inputs, h)
            scale = self.atol + self.rtol * np.maximum(np.abs(self.state), np.abs(after))
            error = float(np.sqrt(np.mean((stages[-1] / scale) ** 2)))
            power, reached = -1 / (self.tableau.order + 1), end if ends else self.time + h
            if error < 1.0 and self.t[k + 1] < reached:
                error = float(np.maximum(error, np.sqrt(np.mean((self._defect(k, h, stages) / scale) ** 2))))
            if error < 1.0 and np.isfinite(after).all():
                self.row = k + int(np.searchsorted(self.t[k + 1 : jump + 1], reached, side="right"))
                for row in range(k + 1, self.row + 1):
                    at = (self.t[row] - self.time) / h
                    x[row] = after if self.t[row] == reached else self.state + self.tableau.along(at) @ stages
                self.time, self.state, fresh, self.begun = reached, after, False, self.row < jump
                grown = h * min(GROW, SAFETY * error**power if error > 0 else GROW)
                self.step = max(self.step, grown) if ends else grown
                if report is not None and self.row > k:
                    report(float(self.t[self.row]))
                continue
            self.step = h * (max(SHRINK, SAFETY * error**power) if np.isfinite(error) else SHRINK)
            if self.step < SMALLEST_STEP * max(1.0, abs(self.time)):
                raise adaptive_steps.too_small_a_step(self.time, self.state, self.step, self.plant.nx, METHOD)

    def _inputs(self, k: int, h: float, at: Array) -> Array:
        """At fractions of a step, (len(at), nu)."""
        if self.law is not None:
            return self.law(self.time + at * h).reshape(len(at), -1)
        return np.tile(self.u[k], (len(at), 1))

    def _linearise(self, u: Array) -> None:
        """df/dx, df/du and df/dt where the step begins."""
        both, drift = slopes(self.plant)(self.time, self.state, u, self.w, self.p)
        self._J, self._B, self._drift = both[:, : self.plant.nx], both[:, self.plant.nx :], drift[:, 0]

    def _stages(self, inputs: Array, h: float) -> tuple[Array, Array]:
        """The state after the step and all stages (s, nx)."""
        from scipy.linalg.lapack import dgetrf, dgetrs

        tableau, t, x = self.tableau, self.time, self.state
        drift = self._drift
        if self.law is not None:
            drift = drift + self._B @ (input_slope(tableau) @ inputs) / h
        lu, order, _ = self._factors = dgetrf(np.eye(len(x)) / (tableau.gamma * h) - self._J)
        stages, y = np.zeros((len(tableau.d), len(x))), x
        for i, u in enumerate(inputs):
            y = x + tableau.A[i, :i] @ stages[:i]
            rate = self.plant._dynamics(t + tableau.alpha[i] * h, y, u, self.w, self.p)[0]
            r = rate + tableau.C[i, :i] @ stages[:i] / h + h * tableau.d[i] * drift
            stages[i] = dgetrs(lu, order, r)[0]
        return y + stages[-1], stages

    def _defect(self, k: int, h: float, stages: Array) -> Array:
        """How far dense output is off where it errs most: W^-1 (f(x) - dx/dt) of it.

        Where motions are stiff it errs by much more than the end of the step does, and that is what it errs by.
        """
        from scipy.linalg.lapack import dgetrs

        tableau, c = self.tableau, self.tableau.worst
        x, u = self.state + tableau.along(c) @ stages, self._inputs(k, h, np.array([c]))[0]
        rate = self.plant._dynamics(self.time + c * h, x, u, self.w, self.p)[0]
        return np.asarray(dgetrs(*self._factors[:2], rate - tableau.slope_along(c) @ stages / h)[0])

    def march_natively(self, library: AdaptiveLibrary, x: Array, last: int) -> None:
        """The same in native code."""
        limits = np.array([self.rtol, self.atol, *adaptive_steps.limits()], dtype=float)
        now = np.concatenate([[self.time, self.step, self.trial], self.state])
        at = np.array([self.row, self.begun, self.steps], dtype=LONG)
        given = (self.ends, np.ascontiguousarray(self.t), self.u, self.w, self.p, x, limits, now, at)
        places, status = [_place(a) for a in given], PAUSED
        most = steps_of_a_call(A_CALL)
        while status == PAUSED:
            check_time(float(now[0]))
            status = int(library.adaptive(last, most, *places))
        (self.time, self.step, self.trial), self.state = now[:3].tolist(), now[3:]
        self.row, self.begun, self.steps = int(at[0]), bool(at[1]), int(at[2])
        if status:
            raise adaptive_steps.stopped(status, self.time, self.state, self.step, self.trial, METHOD)

"""Adaptive explicit integration: the Dormand-Prince pair of order 8(5,3) with one compiled function a step.

Tableau and error norm are DOP853's (Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", II.5 and
II.10). Here all twelve stages are one CasADi function, so that Python is entered once a step
and not once a stage: five to ten times faster on the small systems that plants are. A motion of many steps is compiled
on its way: its numbers are the same to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.runge_kutta_tableaux import dop853_errors, rk8
from pliant.plants.motions import adaptive_steps
from pliant.plants.motions.adaptive_steps import GROW, SAFETY, SHRINK, SMALLEST_STEP
from pliant.plants.motions.time_limit import check_time
from pliant.plants.native.single_point import compiled, pays_after

STAGES = 12


@lru_cache(maxsize=1)
def fractions() -> np.ndarray:
    """Where in the step each stage stands, shape (12,)."""
    return rk8().c


class StepFunction:
    """(t, z, us (nu, 12), w, p, h) -> z(t + h) and the estimates of orders 5 and 3 of its error per unit of h.

    z is the state; with `audit` the net work done [J] follows it. The rates are compiled once that pays.
    """

    def __init__(self, plant: PlantLike, audit: bool) -> None:
        rate = plant.expressions[0]
        if audit:
            rate = ca.vertcat(rate, plant.net_power())  # type: ignore[attr-defined]
        self.nx = plant.nx
        self.rate = ca.Function("rate", list(plant.symbols), [ca.cse(rate)])
        self.left = pays_after(self.rate) // STAGES
        self.step = NumericFunction(self._all_stages(self.rate))

    def _all_stages(self, rate: ca.Function) -> ca.Function:
        tableau, (fifth, third) = rk8(), dop853_errors()
        _, _, nu, nw, np_ = (rate.size1_in(i) for i in range(5))
        z, us, h = ca.MX.sym("z", rate.size1_out(0)), ca.MX.sym("us", nu, STAGES), ca.MX.sym("h")
        t, w, p = ca.MX.sym("t"), ca.MX.sym("w", nw), ca.MX.sym("p", np_)
        k: list[ca.MX] = []
        for i in range(STAGES):
            at = z + h * ca.horzcat(*k) @ tableau.A[i, :i] if i else z
            k.append(rate(t + float(tableau.c[i]) * h, at[: self.nx], us[:, i], w, p))
        slopes = ca.horzcat(*k)
        after = z + h * slopes @ tableau.b
        errors = (slopes @ fifth, slopes @ third)
        return ca.Function("dop853", [t, z, us, w, p, h], [after, *errors])

    def __call__(self, *values: np.ndarray | float) -> list[np.ndarray]:
        self.left -= 1
        if self.left == 0:
            self.step = NumericFunction(self._all_stages(compiled(self.rate)))
        return self.step(*values)


step_function = lru_cache(maxsize=32)(StepFunction)


def first_step(plant: PlantLike, t: float, x: np.ndarray, u: np.ndarray, w: np.ndarray, p: np.ndarray) -> float:
    """A tenth of the fastest mode's time [s]: at an exact equilibrium every error estimate is zero, and what goes by
    those would begin with a step as long as the run.

    The slopes df/dx have half the digits, by differences: a first step needs no more, and the exact Jacobian of a large
    plant takes seconds to build.
    """
    moves = np.sqrt(np.finfo(float).eps) * np.maximum(np.abs(x), 1.0)
    points = np.vstack([x, x + np.diag(moves)])
    rate = np.array([plant._dynamics(t, at, u, w, p)[0] for at in points])
    fastest = np.abs(np.linalg.eigvals(((rate[1:] - rate[0]) / moves[:, None]).T)).max(initial=0.0)
    return float(0.1 / max(fastest, 1e-3))


def march(
    plant: PlantLike,
    times: np.ndarray,
    z: np.ndarray,
    held: np.ndarray,
    law: Callable[[np.ndarray], np.ndarray] | None,
    w: np.ndarray,
    p: np.ndarray,
    *,
    rtol: float,
    atol: float,
    first: float,
    audit: bool,
    report: Callable[[float], None] | None = None,
    before: int = 0,
) -> tuple[np.ndarray, int, float]:
    """States at `times` (nt, nz), the number of steps tried, and the last step, to start the next call with.

    The input is `law(times)` (times * nu,), or `held` (nu,) where that is None. Steps end on every one of the times;
    `before` were tried earlier in the motion.
    """
    step, c = step_function(plant, audit), fractions()
    us = np.tile(held, STAGES)
    out = np.empty((len(times), len(z)))
    out[0] = z
    h, tried = first, 0
    t = float(times[0])
    for k, end in enumerate(times[1:], start=1):
        while t < end:
            check_time(t)
            last = t + h >= end * (1 - 1e-15) or end - t - h < 1e-3 * h
            trial = end - t if last else h
            if law is not None:
                us = law(t + c * trial)
            new, e5, e3 = step(t, z, us, w, p, trial)
            tried += 1
            if before + tried > adaptive_steps.most_steps():
                raise adaptive_steps.too_many_steps(t, z[: plant.nx], trial)
            scale = atol + rtol * np.maximum(np.abs(z), np.abs(new))
            s5, s3 = (e5 / scale) @ (e5 / scale), (e3 / scale) @ (e3 / scale)
            bottom = s5 + 0.01 * s3
            error = trial * s5 / np.sqrt(bottom * len(z)) if bottom != 0 else 0.0
            if error < 1.0:  # False for NaN too
                t, z = (float(end) if last else t + trial), new
                grown = trial * min(GROW, SAFETY * error**-0.125 if error > 0 else GROW)
                h = max(h, grown) if last else grown
                continue
            h = trial * (max(SHRINK, SAFETY * error**-0.125) if np.isfinite(error) else SHRINK)
            if h < SMALLEST_STEP * max(1.0, abs(t)):
                raise adaptive_steps.too_small_a_step(t, z, h, plant.nx)
        out[k] = z
        if report is not None:
            report(t)
    return out, tried, h

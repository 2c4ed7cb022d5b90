"""The law that takes over at the end of a nominal: one period about the goal that is held, of a plant or a model.

K (T+1, nu, nx), x (T+1, nx), u (T+1, nu) are those of the law along the nominal, whose last entries are the goal's.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.splines.cubic_spline import CubicSpline

from .hold_set import Hold
from .period_cost import period_weight


def held_by_plant(
    K: np.ndarray, x: np.ndarray, steps: HeldSteps, hold: tuple[Any, Any, Any], weights: tuple[Any, Any, Any]
) -> Hold:
    """The held law about a period of the plant at its goal; weights Q, R, N of a period, or with a leading T."""
    found, nx = steps.slopes(*(np.array(value, dtype=float)[None] for value in hold[1:])), x.shape[-1]
    A, B = found.slope[0][:, :nx], found.slope[0][:, nx:]
    given = [np.zeros_like(B) if M is None else np.asarray(M, dtype=float) for M in weights]
    Q, R, N = (M[-1] if M.ndim == 3 else M for M in given)
    return Hold(A, B, K[-1], found.end[0] - x[-1], period_weight(Q, R, N))


def held_by_model(K: np.ndarray, x: np.ndarray, u: np.ndarray, ltv: LTVModel, weights: tuple[Any, Any, Any]) -> Hold:
    """The held law about the model's last node; weights Q, R, N of the integral."""
    end, dt = ltv.at(-1), float(np.diff(ltv.t).mean())
    after, period = end.discretize(dt), riccati.sampled(end.A, end.B, *weights, dt=dt)
    dx, du = x[-1] - ltv.x[-1], u[-1] - ltv.u[-1]
    moves = CubicSpline(ltv.t, ltv.x)(ltv.t[-1], 1) * dt  # f at the last node is c and the nominal's own rate
    rest = after.A @ dx + after.B @ du + after.f0 + moves - dx
    return Hold(period.A, period.B, K[-1], rest, period_weight(*period[2:]))

"""Least squares within bounds, by Levenberg's and Marquardt's method: min |r(z)|^2/2 with lower <= z <= upper.

Each step solves min |R s + r|^2 + lambda |D s|^2 within the bounds, D the largest column norms so far (Moré 1978, "The
Levenberg-Marquardt algorithm: implementation and theory"), by an active-set method, so that no point outside is ever
tried. lambda follows Nielsen 1999, "Damping parameter in Marquardt's method", and falls the faster the more steps in
turn gained what they promised: directions that the data hardly tell, as of unknown starts, else cost a step for each
factor of three. The search ends where an undamped step promises a decrease below TOLERANCE: with residuals in standard
deviations, 1e-3 of a standard error of anything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray
TOLERANCE, ROUNDING = 5e-7, 1e-9  # decrease that ends the search, and relative to the cost
STALLED = 1e-3  # promised decrease, 0.04 standard errors, that may be left where a step gains nothing: rounding
FIRST, LARGEST, SMALLEST = 1e-3, 1e12, 1e-12  # lambda
FALL, AS_PROMISED = 1 / 3, 0.9  # its factor after a step, squared at each next that gained such a part of its promise
MOST = 60  # evaluations


@dataclass(frozen=True, eq=False)
class Linearised:
    """r(z + s) ~ R s + r, both condensed by an orthogonal matrix; `rest` is what no s changes of |r|^2/2."""

    R: Array  # (k, n)
    r: Array  # (k,)
    rest: float

    @property
    def cost(self) -> float:
        """|r|^2/2."""
        return float(self.r @ self.r) / 2 + self.rest


@dataclass(frozen=True, eq=False)
class Found:
    """Where the search ended, and whether because nothing was left to gain."""

    z: Array
    at: Linearised
    evaluations: int
    converged: bool
    damping: float  # lambda: where a search for nearly the same begins


def minimise(
    linearise: Callable[[Array], Linearised | None],
    z: Array,
    lower: Array,
    upper: Array,
    *,
    most: int = MOST,
    damping: float = FIRST,
    told: Callable[[int, float], None] | None = None,
) -> Found | None:
    """From z, within the bounds. `linearise` gives None where the residual is not finite; so does this at the start."""
    z = np.clip(z, lower, upper)
    at, used, factor, fall, worked = linearise(z), 1, 2.0, FALL, FIRST
    if at is None:
        return None
    D = np.zeros_like(z)
    while True:
        D = np.maximum(D, np.linalg.norm(at.R, axis=0))
        if told is not None:
            told(used, at.cost)
        left = at.cost - at.rest - _value(at, within(at.R, at.r, lower - z, upper - z))
        if left <= TOLERANCE + ROUNDING * at.cost:
            return Found(z, at, used, True, damping)
        if used >= most or damping > LARGEST:
            return Found(z, at, used, False, damping)
        size = np.where(D > 0, D, 1.0)
        s = within(np.vstack([at.R, np.sqrt(damping) * np.diag(size)]), np.append(at.r, 0 * z), lower - z, upper - z)
        promised = at.cost - at.rest - _value(at, s)
        trial = np.clip(z + s, lower, upper)
        new = linearise(trial) if promised > 0 else None
        used += promised > 0
        gain = (at.cost - new.cost) / promised if new is not None else -1.0
        if new is not None and gain > 0:
            z, at, factor, worked = trial, new, 2.0, damping
            damping = max(SMALLEST, damping * max(fall, 1 - (2 * gain - 1) ** 3))
            fall = fall**2 if gain > AS_PROMISED else FALL
        elif left <= STALLED:
            return Found(z, at, used, True, damping)
        else:
            damping, factor, fall = max(damping, worked) * factor, 2 * factor, FALL


def _value(at: Linearised, s: Array) -> float:
    left = at.R @ s + at.r
    return float(left @ left) / 2


def within(R: Array, r: Array, low: Array, high: Array) -> Array:
    """The s that minimises |R s + r| with low <= s <= high, the shortest where there are several."""
    s: Array = np.linalg.lstsq(R, -r, rcond=1e-13)[0]
    if (s >= low).all() and (s <= high).all():
        return s
    from scipy.optimize import lsq_linear

    room = np.maximum(high - low, 0.0)
    open_ = room > 0  # lsq_linear wants low < high
    s = np.clip(np.zeros_like(low), low, high)
    if open_.any():
        low, high = np.minimum(low[open_], 0.0), np.maximum(high[open_], 0.0)
        s[open_] = lsq_linear(R[:, open_], -r, (low, high), method="bvls", tol=1e-12).x.clip(low, high)
    return s

"""Inputs that are dear to evaluate as polynomials in time: inverse dynamics at every stage of an integrator.

Chebyshev interpolants of degree DEGREE on equal panels, halved until their last coefficients and what they miss at
other times of every panel fall below CLOSE of the largest input; where that is not reached (a kink) the law itself
serves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

Array = np.ndarray
DEGREE, CLOSE = 15, 1e-11
PANELS = (4, 8, 16, 32)
TRIED = np.array([-0.93, -0.41, 0.17, 0.77])  # of a panel, where the interpolant is held against the law


class TabulatedInputs:
    """u(t) (nu,) of a law with `at_times` and `time` [s], from which on it is the law itself."""

    def __init__(self, law: Any, coefficients: Array) -> None:
        self.law, self.time, self.coefficients = law, float(law.time), coefficients  # (panels, DEGREE + 1, nu)

    def __call__(self, t: float) -> Array:
        """The inputs at one time."""
        return self.at_times(np.array([float(t)]))[0]

    def at_times(self, times: Array) -> Array:
        """The inputs (n, nu) at times (n,)."""
        times = np.asarray(times, dtype=float)
        inside = (times >= 0.0) & (times < self.time)
        if not inside.all():
            found = np.empty((len(times), self.coefficients.shape[-1]))
            found[~inside] = self.law.at_times(times[~inside])
            found[inside] = self.at_times(times[inside]) if inside.any() else 0.0
            return found
        panels = len(self.coefficients)
        place = times / self.time * panels
        panel = np.minimum(place.astype(int), panels - 1)
        x = 2 * (place - panel) - 1
        powers = np.cos(np.arange(DEGREE + 1) * np.arccos(np.clip(x, -1.0, 1.0))[:, None])
        return np.einsum("nk,nku->nu", powers, self.coefficients[panel])


def tabulated(law: Any) -> Any:
    """The law's inputs from a table, to CLOSE of the largest; the law itself where it has no `at_times` and `time`, or
    is not smooth enough.

    >>> u = tabulated(arm.rest_to_rest(begin, end, time=1.0))
    """
    if not callable(getattr(law, "at_times", None)) or not isinstance(getattr(law, "time", None), float):
        return law
    nodes = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    for panels in PANELS:
        middle = (np.arange(panels)[:, None] + (1 + np.concatenate([nodes, TRIED])) / 2) / panels
        values = law.at_times(law.time * middle.ravel()).reshape(panels, len(nodes) + len(TRIED), -1)
        size = float(np.abs(values).max(initial=0.0))
        found = np.array([chebyshev.chebfit(nodes, own[: len(nodes)], DEGREE) for own in values])
        table = TabulatedInputs(law, found)
        missed = np.abs(table.at_times(law.time * middle.ravel()) - values.reshape(-1, values.shape[-1]))
        last = np.abs(found[:, -2:]).max(initial=0.0)
        if np.isfinite(size) and max(missed.max(initial=0.0), last) <= CLOSE * size:
            return table
    return law

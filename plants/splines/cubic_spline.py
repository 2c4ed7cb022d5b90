"""Piecewise cubics in time through values at nodes.

Slopes s_k at the nodes, h_k = t_k+1 - t_k, d_k = (f_k+1 - f_k)/h_k (de Boor, A practical guide to splines, chapter IV):

    h_k s_k-1 + 2 (h_k-1 + h_k) s_k + h_k-1 s_k+1 = 3 (h_k d_k-1 + h_k-1 d_k)

and at either end the third derivative does not jump at the second node ("not-a-knot"). Two nodes: a line, three: a
parabola. The same digits as scipy.interpolate's, whose import takes longer than most motions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray
TOGETHER = 30_000  # numbers found at once: what a core has at hand


class CubicHermite:
    """Through f (m, ..) with slopes s (m, ..) at t (m,), two or more that increase; beyond the nodes as on the interval
    beside. ValueError for other nodes, and for numbers that are not finite.
    """

    def __init__(self, t: Any, f: Any, s: Any) -> None:
        self.t, f, s = _checked("CubicHermite", t, f=f, s=s)
        h = np.diff(self.t).reshape(-1, *(1,) * (f.ndim - 1))
        d = np.diff(f, axis=0) / h
        bend = (s[:-1] + s[1:] - 2 * d) / h
        self.of_power = (f[:-1], s[:-1], (d - s[:-1]) / h - bend, bend / h)  # of (time - t_k)^0 .. ^3

    def __call__(self, at: Any, derivative: int = 0) -> Array:
        """Values at the times `at`, their shape and then the values' own; derivative 1: the slopes there."""
        if derivative not in (0, 1):
            raise ValueError(f"{type(self).__name__}: derivative = {derivative!r} must be 0 or 1")
        at, own = np.asarray(at, dtype=float), self.of_power[0].shape[1:]
        times, size = at.ravel(), max(int(np.prod(own)), 1)
        found, some = np.empty((len(times), *own)), max(TOGETHER // size, 1)
        for begin in range(0, len(times), some):
            part = slice(begin, begin + some)
            self._into(found[part], times[part], derivative)
        return found.reshape((*at.shape, *own))

    def _into(self, found: Array, times: Array, derivative: int) -> None:
        k = np.clip(np.searchsorted(self.t, times, side="right") - 1, 0, len(self.t) - 2)
        z = (times - self.t[k]).reshape(-1, *(1,) * (found.ndim - 1))
        np.take(self.of_power[derivative], k, axis=0, out=found, mode="clip")
        risen = z
        for power in range(derivative + 1, 4):
            term = self.of_power[power][k]
            term *= risen
            if derivative:
                term *= power
            found += term
            risen = risen * z


class CubicSpline(CubicHermite):
    """The smooth one through f (m, ..) at t (m,), two or more that increase.

    Example
    -------
    >>> CubicSpline([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 8.0, 27.0])(1.5)
    array(3.375)
    """

    def __init__(self, t: Any, f: Any) -> None:
        t, f = _checked("CubicSpline", t, f=f)
        super().__init__(t, f, slopes(t, f.reshape(len(t), -1)).reshape(f.shape))


def _checked(owner: str, t: Any, **values: Any) -> list[Array]:
    """Nodes, and what stands at them, as float64; core's gates come after this room."""
    nodes = np.asarray(t, dtype=float)
    if nodes.ndim != 1 or len(nodes) < 2:
        raise ValueError(f"{owner}.t has shape {nodes.shape}, must be (m,), two nodes or more")
    steps = np.diff(nodes)
    bad = np.flatnonzero(~((steps > 0) & (steps < np.inf)))
    if bad.size:
        k = int(bad[0])
        raise ValueError(
            f"{owner}.t[{k}], [{k + 1}] = {nodes[k]:.9g}, {nodes[k + 1]:.9g} must be finite and strictly increasing"
        )
    found = [np.asarray(value, dtype=float) for value in values.values()]
    for name, value in zip(values, found):
        if value.shape[:1] != nodes.shape or value.shape != found[0].shape:
            like = nodes.shape if value is found[0] else found[0].shape
            raise ValueError(f"{owner}.{name} has shape {value.shape}, must be {like}, a row a node")
        if not np.isfinite(value).all():
            raise ValueError(f"{owner}.{name} has entries that are not finite, must be finite numbers")
    return [nodes, *found]


def slopes(t: Array, f: Array) -> Array:
    """(m, k) at the nodes t (m,) of the spline through f (m, k)."""
    h = np.diff(t)
    column = h[:, None]
    d = np.diff(f, axis=0) / column
    if len(h) == 1:
        return np.concatenate([d, d])
    if len(h) == 2:
        A = np.array([[1.0, 1.0, 0.0], [h[1], 2 * (h[0] + h[1]), h[0]], [0.0, 1.0, 1.0]])
        return np.asarray(np.linalg.solve(A, np.array([2 * d[0], 3 * (h[0] * d[1] + h[1] * d[0]), 2 * d[1]])))
    from scipy.linalg import solve_banded

    bands, right = np.zeros((3, len(t))), np.empty_like(f)
    first, last = t[2] - t[0], t[-1] - t[-3]
    bands[0, 2:], bands[1, 1:-1], bands[2, :-2] = h[:-1], 2 * (h[:-1] + h[1:]), h[1:]
    bands[1, 0], bands[0, 1], bands[1, -1], bands[2, -2] = h[1], first, h[-2], last
    right[1:-1] = 3 * (column[1:] * d[:-1] + column[:-1] * d[1:])
    right[0] = ((h[0] + 2 * first) * h[1] * d[0] + h[0] ** 2 * d[1]) / first
    right[-1] = (h[-1] ** 2 * d[-2] + (2 * last + h[-1]) * h[-2] * d[-1]) / last
    return np.asarray(solve_banded((1, 1), bands, right, check_finite=False))

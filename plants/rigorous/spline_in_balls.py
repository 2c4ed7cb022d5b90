"""The cubic spline through given doubles, as scipy's `CubicSpline` defines it ("not-a-knot"), in balls.

Slopes s_k at the nodes, h_k = t_k+1 - t_k, d_k = (f_k+1 - f_k)/h_k (de Boor, A practical guide to splines, IV):
    h_k s_k-1 + 2 (h_k-1 + h_k) s_k + h_k-1 s_k+1 = 3 (h_k d_k-1 + h_k-1 d_k)
and at either end the third derivative does not jump at the second node. Two nodes: a line, three: a parabola. The
system is solved by elimination from the start, whose pivots are dominant: balls stay as small as their bits.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from .balls import flint, matrix


def cubics(t: np.ndarray, f: np.ndarray) -> list[tuple[Any, Any, Any, Any]]:
    """Of f (m + 1, c) at t (m + 1,), for each interval the coefficients (1, c) of (time - t_k)^0 .. ^3."""
    arb = flint().arb
    at, rows = [arb(float(x)) for x in t], [matrix(row[None]) for row in f]
    h = [b - a for a, b in pairwise(at)]
    d = [(b - a) / step for a, b, step in zip(rows, rows[1:], h)]
    if len(h) == 1:
        zero = matrix(np.zeros((1, f.shape[1])))
        return [(rows[0], d[0], zero, zero)]
    if len(h) == 2:
        bend = (d[1] - d[0]) / (h[0] + h[1])
        s = [d[0] - bend * h[0], d[0] + bend * h[0], d[1] + bend * h[1]]
    else:
        s = _slopes(h, d)
    found = []
    for k, step in enumerate(h):
        c3 = (s[k] + s[k + 1] - 2 * d[k]) / step
        found.append((rows[k], s[k], (d[k] - s[k]) / step - c3, c3 / step))
    return found


def _slopes(h: list[Any], d: list[Any]) -> list[Any]:
    m, wide, late = len(h), h[0] + h[1], h[-1] + h[-2]
    right = [(d[0] * ((h[0] + 2 * wide) * h[1]) + d[1] * h[0] ** 2) / wide]
    above = [wide / h[1]]
    right[0] = right[0] / h[1]
    for k in range(1, m):
        pivot = 2 * (h[k - 1] + h[k]) - h[k] * above[k - 1]
        above.append(h[k - 1] / pivot)
        right.append(((d[k - 1] * h[k] + d[k] * h[k - 1]) * 3 - right[k - 1] * h[k]) / pivot)
    last = (d[-2] * h[-1] ** 2 + d[-1] * ((2 * late + h[-1]) * h[-2])) / late
    s = [(last - right[-1] * late) / (h[-2] - late * above[-1])]
    for k in range(m - 1, -1, -1):
        s.append(right[k] - s[-1] * above[k])
    return s[::-1]

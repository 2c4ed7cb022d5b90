"""Entries of A(t) between their nodes, and a bound on what the nodes do not show.

Each interval and entry has the interpolant that is known best there, judged by the nodes about it alone:

cubic       Hermite cubic, slopes from five nodes. Its error is w |f[5 nodes]|, w = h^2/4 (h- + h/2)(h+ + h/2): at least
            f''''h^4/384. Where f is smooth the fourth difference falls sixteenfold when its nodes move together by
            half, at a kink twofold, at a jump not at all. So: where that of neighbouring nodes is SMOOTH times smaller
            than that of every other node the cubic is believed; else its error counts ROUGH times: a kink in
            mid-interval makes it 16 w |f[5 nodes]|. An interval much longer than one beside it shows neither. Nor is it
            believed where five nodes' fourth difference is no smaller than the largest second one among them, as at
            each kink and jump: beside a large jump every other node's is large, and hides a small one.
linear      Let `left` be the miss at t[k+1] of the line through nodes k-1, k and `right` that at t[k] of the line
            through k+1, k+2, or with the slope of the interval after it, which a kink beside this one spares. A kink at
            a share s of the interval makes them |ds| h (1-s) and |ds| h s, and the area between f and the chord is
            |ds| h^2 s (1-s)/2 <= h min(left, right)/2; a jump J makes both J, and an area of h J/2 at most; curvature
            f'' makes both h^2 f'' and an area of h^3 f''/12.
harmonics   equidistant nodes of a period, where a whole run of the last quarter of them, at least four, is quiet: what
            is beyond is taken as four times that run (it is 1.5 times for coefficients that fall as j^-4). One quiet
            coefficient shows nothing: symmetry makes it zero.

What leaves no trace at any node cannot be known from the nodes.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from pliant.plants.core.signals import OwnsArrays

SMOOTH, ROUGH = 9.0, 32.0
FALLS = 1.25  # times the second difference: a fourth one larger than that is no smooth function's
LONE = 0.3  # of an interval's length: one beside it that is shorter does not help to judge it
FEW = 12  # intervals below which nothing is measured, and the steps between the nodes count too, ..
STEP = 0.5  # .. so much of them
FEWEST = 9  # intervals with harmonics enough for a run of four beside the first
GHOSTS = 8  # nodes of the neighbouring periods that are looked at
QUIET = 1e-3  # of an entry's range
MOST_HARMONICS = 256
COLUMNS = 64  # entries at a time, so that they stay in cache
EPS = float(np.finfo(float).eps)


class Interpolant(OwnsArrays):
    """f (nt, c) at nodes t (nt,) [s], as a function of time; `periodic`: the last row is the first.

    `area` (nt-1, c) bounds the integral of what is missed over each interval [unit of f times s], `most` (nt-1, c) its
    largest size; `harmonics` that are kept, 0 where none; `waves` (c,) the entries that are sums of harmonics.
    """

    def __init__(self, t: np.ndarray, f: np.ndarray, *, periodic: bool = False) -> None:
        self.t, self.h, self.f = t, np.diff(t), f
        m, c = len(self.h), f.shape[1]
        self.area, self.most = np.zeros((m, c)), np.zeros((m, c))
        self.begin, self.end = np.zeros((m, c)), np.zeros((m, c))
        self.harmonics = 0
        self.waves = np.zeros(c, dtype=bool)
        for k in range(0, c, COLUMNS):
            self._local(np.arange(k, min(k + COLUMNS, c)), periodic)
        if periodic and m >= FEWEST and np.ptp(self.h) <= 1e-7 * self.h.mean():
            self._harmonic(np.arange(c))

    def integral(self, column: int) -> tuple[float, float]:
        """Of one entry over all intervals, and what it may be off."""
        error = float(self.area[:, column].sum())
        if self.waves[column]:
            return float(self.f[:-1, column].mean() * self.h.sum()), error
        ends = (self.f[1:, column] + self.f[:-1, column]) / 2
        bend = (self.begin[:, column] - self.end[:, column]) / 12
        return float((self.h * ends + self.h**2 * bend).sum()), error

    def add(self, k: Any, miss: np.ndarray) -> None:
        """Count a miss (.., c) in interval k on top of what the nodes show."""
        self.area[k] += miss * np.expand_dims(self.h[k], -1)
        self.most[k] += miss

    def beside(self) -> np.ndarray:
        """`most` (nt-1, c) of the neighbouring intervals, over the seam too: a time may fall into them by rounding."""
        return np.maximum(np.roll(self.most, 1, axis=0), np.roll(self.most, -1, axis=0))

    def __call__(self, times: np.ndarray) -> np.ndarray:
        times = np.asarray(times, dtype=float)
        k = np.clip(np.searchsorted(self.t, times, side="right") - 1, 0, len(self.h) - 1)
        s = ((times - self.t[k]) / self.h[k])[:, None]
        found = self._cubics[3][k]
        for power in (2, 1, 0):
            found *= s
            found += self._cubics[power][k]
        if self.harmonics or self.waves.any():
            angle = np.outer(times - self.t[0], self.omega)
            found[:, self.waves] = np.hstack([np.cos(angle), np.sin(angle)]) @ self.weights
        return found

    @cached_property
    def _cubics(self) -> tuple[np.ndarray, ...]:
        """Coefficients (nt-1, c) of the powers 0 to 3 of the share of an interval that is past."""
        low, rise = self.f[:-1], np.diff(self.f, axis=0)
        b, e = (slope * self.h[:, None] - rise for slope in (self.begin, self.end))  # beyond the chord
        return low, rise + b, -2 * b - e, b + e

    def _local(self, those: np.ndarray, wrap: bool) -> None:
        t, f, T = self.t, self.f[:, those], self.t[-1] - self.t[0]
        m = len(self.h)
        g = min(GHOSTS, m) if wrap else 0
        if g:
            t = np.concatenate([t[-g - 1 : -1] - T, t, t[1 : g + 1] + T])
            f = np.concatenate([f[-g - 1 : -1], f, f[1 : g + 1]])
        own = slice(g, g + m)
        h = np.diff(t)
        d1 = np.diff(f, axis=0) / h[:, None]
        area, most = _linear(h, d1)
        if m < FEW:
            area += STEP * np.abs(d1) * h[:, None] ** 2
            most += np.abs(d1) * h[:, None]
        begin, end = d1.copy(), d1.copy()
        if m >= FEW:
            slope, cubic = _cubic(t, f, h, d1)
            better = 2 / 3 * h[:, None] * cubic < area
            area, most = np.where(better, 2 / 3 * h[:, None] * cubic, area), np.where(better, cubic, most)
            begin, end = np.where(better, slope[:-1], d1), np.where(better, slope[1:], d1)
        rounding = 4 * EPS * np.abs(f).max(axis=0, initial=0.0)
        self.area[:, those], self.most[:, those] = (area + rounding * h[:, None])[own], (most + rounding)[own]
        self.begin[:, those], self.end[:, those] = begin[own], end[own]

    def _harmonic(self, those: np.ndarray) -> None:
        f, m = self.f[:-1, those], len(self.h)
        c = np.fft.rfft(f, axis=0) / m
        c[1:] *= 2.0
        if m % 2 == 0:
            c[-1] /= 2.0
        size = np.abs(c)
        run = min(3 * len(c) // 4, len(c) - 4)
        last, rounding = size[run:].sum(axis=0), 8 * EPS * np.abs(f).max(axis=0, initial=0.0)
        error = 4 * last + rounding
        good = (last <= QUIET * np.ptp(f, axis=0)) & (error * self.h.sum() < self.area[:, those].sum(axis=0))
        if not good.any():
            return
        tail = np.cumsum(size[::-1], axis=0)[::-1]
        K = max(1, int((tail > rounding)[:, good].any(axis=1).sum()))
        if K > MOST_HARMONICS:
            return
        those, c, error = those[good], c[:K, good], error[good]
        self.harmonics, self.waves[those] = K - 1, True
        self.omega = 2 * np.pi / (self.t[-1] - self.t[0]) * np.arange(K)
        self.weights = np.concatenate([c.real, -c.imag])
        self.area[:, those], self.most[:, those] = error * self.h[:, None], error


def _linear(h: np.ndarray, d1: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Area (m, c) and size (m, c) of what the chord misses, from the slopes d1 (m, c) of all intervals h (m,)."""
    miss = np.zeros((2, *d1.shape))
    if len(d1) == 1:
        miss[:] = np.abs(d1)
    else:
        turn = np.abs(np.diff(d1, axis=0))
        miss[0, 1:], miss[1, :-1] = turn, turn
    largest = miss.max(axis=0)
    further = np.abs(d1[2:] - d1[:-2])  # where the neighbour holds a kink of its own
    miss[0, 2:], miss[1, :-2] = np.maximum(miss[0, 2:], further), np.maximum(miss[1, :-2], further)
    miss[0, 0], miss[1, -1] = miss[1, 0], miss[0, -1]  # ends: what the one side shows
    least = miss.min(axis=0)
    return h[:, None] ** 2 * (least / 2 + largest / 20), h[:, None] * np.maximum(least, largest)


def _cubic(t: np.ndarray, f: np.ndarray, h: np.ndarray, d1: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (nt, c) at the nodes from five of them, and what a cubic with these misses at most (nt-1, c)."""
    m, near = len(h), [d1]
    for order in (2, 3, 4):
        near.append(np.diff(near[-1], axis=0) / (t[order:] - t[:-order])[:, None])
    apart = f
    for order in (2, 4, 6, 8):
        apart = (apart[2:] - apart[:-2]) / (t[order:] - t[:-order])[:, None]
    bend = np.abs(near[3])
    close = _ends_filled(_covering(bend, m, 4), 3)
    width = ((t[4:] - t[:-4]) / 4)[:, None]  # of each five nodes
    fine = _ends_filled(_covering(bend * width**4, m, 4), 3)
    bent = np.max([np.abs(near[1][k : k + m - 3]) for k in range(3)], axis=0)
    falls = _ends_filled(_covering((FALLS * 12 * width**2 * bend > bent).astype(float), m, 4), 3) == 0
    wide = _covering(np.abs(apart) * ((t[8:] - t[:-8]) / 4)[:, None] ** 4, m, 8)
    before, after = np.r_[h[0], h[:-1]], np.r_[h[1:], h[-1]]
    largest = np.max(
        [np.r_[[h[0]] * k, h[: m - k]] for k in (0, 1, 2)] + [np.r_[h[k:], [h[-1]] * k] for k in (1, 2)], 0
    )
    w = np.maximum(h**2 / 4 * (before + h / 2) * (after + h / 2), 0.1 * h * largest**3)
    beside = np.minimum(before, after) >= LONE * h
    cubic = close * w[:, None] * np.where((SMOOTH * fine <= wide) & beside[:, None] & falls, 1.0, ROUGH)
    start = np.clip(np.arange(m + 1) - 2, 0, m - 4)
    a, b, c, d = (t - t[start + k] for k in range(4))
    slope = (
        near[0][start]
        + near[1][start] * (a + b)[:, None]
        + near[2][start] * (a * b + a * c + b * c)[:, None]
        + near[3][start] * (a * b * c + a * b * d + a * c * d + b * c * d)[:, None]
    )
    return slope, cubic


def _covering(values: np.ndarray, m: int, width: int) -> np.ndarray:
    """Largest of the values (m+1-width, c) whose stencils of `width` intervals cover each of the m intervals."""
    found = np.zeros((m, values.shape[1]))
    for k in range(width):
        np.maximum(found[k : k + len(values)], values, out=found[k : k + len(values)])
    return found


def _ends_filled(values: np.ndarray, count: int) -> np.ndarray:
    """values (m, c), the first and last `count` of which are at least the first that all stencils cover.

    Of a kink a third of the way into the second interval the one stencil that covers the first shows nothing.
    """
    values[:count] = np.maximum(values[:count], values[count])
    values[-count:] = np.maximum(values[-count:], values[-count - 1])
    return values

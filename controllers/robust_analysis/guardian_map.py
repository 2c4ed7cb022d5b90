"""A box of parameters in parts, in each of which a loop is shown to be stable: none holds a zero of its guardian map.

    g(delta) = prod_{i <= j} (1 - lambda_i lambda_j)        of x[k+1] = A(delta) x[k]
    g(delta) = prod_{i <= j} -(lambda_i + lambda_j)         of dx/dt = A(delta) x

over the eigenvalues of A: positive where the loop is stable, zero where it is at its limit, so that a box with one
stable member and no zero of g is stable. A pair gives 1 - |lambda|^2 whatever its frequency, and as a product over all
g is as smooth as A, where eigenvalues meet too: it is interpolated at Chebyshev's points of a part, less its trend (log
g is linear), and its Bernstein coefficients on a few pieces of the part bound it from below.

What is not shown is what the interpolation lacks: it was measured between the points, at corners and sides, and twice
the largest, or twice the last coefficients where these are more, stands for it. The part next to the middle is looked
at first, and halved where it is not shown. A itself is interpolated over the box where that agrees to AGREES.

Source   Saydy, Tits and Abed 1990, "Guardian maps and the generalized stability of parametrized families of matrices
         and polynomials"; Garloff 1993, "The Bernstein algorithm", for bounds of a polynomial on a box
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise, product
from math import comb

import numpy as np

from pliant.plants.core.imports import linalg

from .parts_of_box import Parts

Array = np.ndarray
TWICE = 2.0  # times what was measured
POINTS = {1: 9, 2: 7, 3: 5, 4: 4}  # by parameters, along each of a part; of more it is not tried
PIECES = 4  # of a part along each parameter
LAST = 2  # coefficients of the highest degrees
AGREES = 1e-10  # of A in even units
NUMBERS = (
    4,
    5,
    6,
    7,
    8,
    10,
    12,
    16,
    20,
    24,
    32,
    40,
    48,
)  # of points of the whole box along a parameter, at which A is taken
MOST_POINTS, TRIES = 4000, 3  # in all; numbers of points that are tried
DEARER = 10  # a look without that
PAST = 1e-9  # of a rate or a size: growth that is no rounding
SMALLEST = 1e-4  # of the box: width of a part that is not halved again


def free_of_zeros(state_matrix: Callable[[Array], Array], count: int, dt: float | None, most: int) -> Parts:
    """Of the box |delta_i| <= 1 of `count` parameters, by at most so many looks at a part; a tenth of them where A is
    not interpolated, and each look takes as many of the loop's own matrices as it has points."""
    if count not in POINTS:
        return Parts(0.0, 0, 0.0, None, True)
    x, to_series, to_bernstein = _tables(POINTS[count])
    between = _between(count)
    matrices = _interpolated(state_matrix, count)
    most = most if matrices.series is not None else -(-most // DEARER)
    waiting: list[tuple[float, int, Array, Array]] = [(0.0, 0, np.zeros(count), np.ones(count))]
    parts, left, stood, unstable = 0, 0.0, 1.0, None
    for looked in range(most + 1):
        if not waiting or waiting[0][0] >= stood:
            break
        near, _, centre, half = heapq.heappop(waiting)
        if looked == most:
            return Parts(near, parts, left, unstable, True)
        places = [c + h * x for c, h in zip(centre, half)]
        at = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, count)
        every = matrices.on_grid(places), matrices.at(centre + half * between)
        logs, sizes = _logarithms(np.concatenate(every), dt)
        if (limit := float(sizes.max())) >= 0:
            worst = np.concatenate([at, centre + half * between])[int(sizes.argmax())]
            size = float(np.abs(worst).max())
            if limit > PAST and size < stood:
                stood, unstable = size, worst
        trend = np.concatenate([np.ones((len(logs), 1)), np.concatenate([(at - centre) / half, between])], axis=1)
        g = np.exp(logs - trend @ np.linalg.lstsq(trend, logs, rcond=None)[0])
        values = g[: len(at)].reshape((len(x),) * count)
        series = _along([to_series] * count, values)
        lacks, axis = _lacks(series, between, g[len(at) :])
        if limit < 0 and _least(values, to_bernstein) > TWICE * lacks:
            parts, left = parts + 1, max(left, lacks)
            continue
        if half.max() < SMALLEST:
            return Parts(near, parts, left, unstable)
        wide = np.eye(count)[axis] * half / 2
        for k, c in enumerate((centre - wide, centre + wide)):
            h = half - np.abs(wide)
            heapq.heappush(waiting, (float(np.maximum(np.abs(c) - h, 0.0).max()), 2 * looked + k + 1, c, h))
    return Parts(stood, parts, left, unstable)


def _logarithms(A: Array, dt: float | None) -> tuple[Array, Array]:
    """log |g| of A (m, n, n), and how far its fastest growing eigenvalue is past the limit: below 0 where stable."""
    values = np.linalg.eigvals(A)
    i, j = np.triu_indices(A.shape[-1])
    if dt is None:
        factors, past = -(values[:, i] + values[:, j]), values.real.max(axis=1)
        return np.log(np.maximum(np.abs(factors), 1e-300)).sum(axis=1), past
    factors = 1 - values[:, i] * values[:, j]
    return np.log(np.maximum(np.abs(factors), 1e-300)).sum(axis=1), np.abs(values).max(axis=1) - 1


def _lacks(series: Array, between: Array, g: Array) -> tuple[float, int]:
    """What the series lacks, and along which parameter its last coefficients are the largest."""
    m, count = len(series), series.ndim
    rows = [np.polynomial.chebyshev.chebvander(between[:, a], m - 1) for a in range(count)]
    found = np.tile(series[None], (len(between), *(1,) * count))
    for row in rows:
        found = np.einsum("pi,pi...->p...", row, found)
    degree = np.indices(series.shape)
    last = [float(np.abs(series[degree[a] >= m - LAST]).sum()) for a in range(count)]
    return max(float(np.abs(found - g).max()), *last), int(np.argmax(last))


def _least(values: Array, to_bernstein: Array) -> float:
    """The least Bernstein coefficient over all pieces of the part."""
    pieces = (_along([to_bernstein[i] for i in piece], values) for piece in product(range(PIECES), repeat=values.ndim))
    return min(float(one.min()) for one in pieces)


def _along(matrices: list[Array], values: Array) -> Array:
    """One matrix along each axis."""
    for axis, M in enumerate(matrices):
        values = np.moveaxis(np.tensordot(M, values, axes=(1, axis)), 0, axis)
    return values


@lru_cache(maxsize=16)
def _points(m: int) -> tuple[Array, Array]:
    """Chebyshev's points (m,) and the matrix from values there to coefficients of Chebyshev's polynomials."""
    x = -np.cos(np.pi * (2 * np.arange(m) + 1) / (2 * m))
    return x, np.linalg.inv(np.polynomial.chebyshev.chebvander(x, m - 1))


@lru_cache(maxsize=8)
def _tables(m: int) -> tuple[Array, Array, Array]:
    """`_points`, and matrices (PIECES, m, m) from values there to Bernstein coefficients on each piece of [-1, 1]."""
    x, to_series = _points(m)
    t, n = np.linspace(0, 1, m), m - 1
    bernstein = np.array([[comb(n, j) * s**j * (1 - s) ** (n - j) for j in range(m)] for s in t])
    ends = np.linspace(-1, 1, PIECES + 1)
    pieces = [np.polynomial.chebyshev.chebvander(a + (b - a) * t, n) @ to_series for a, b in pairwise(ends)]
    return x, to_series, np.linalg.solve(bernstein, np.array(pieces))


@lru_cache(maxsize=8)
def _between(count: int) -> Array:
    """Where a part is looked at besides: corners, middles of the sides, and points drawn once."""
    corners = np.array(list(product((-1.0, 1.0), repeat=count)))
    drawn = np.random.default_rng(0).uniform(-1, 1, (4 * count, count))
    return np.concatenate([corners, np.eye(count), -np.eye(count), drawn])


@dataclass(frozen=True)
class _Matrices:
    """A(delta) of a box: interpolated by `series` where there is one, else the loop's own."""

    own: Callable[[Array], Array]
    series: Array | None

    def on_grid(self, places: list[Array]) -> Array:
        """(prod m, n, n) at all combinations of the parameters' values."""
        if self.series is None:
            return np.array([self.own(np.array(d)) for d in product(*places)])
        rows = [np.polynomial.chebyshev.chebvander(place, m - 1) for place, m in zip(places, self.series.shape)]
        return _along(rows, self.series).reshape(-1, *self.series.shape[-2:])

    def at(self, points: Array) -> Array:
        """(m, n, n) at points (m, k)."""
        if self.series is None:
            return np.array([self.own(d) for d in points])
        return np.concatenate([self.on_grid(list(d[:, None])) for d in points])


def _interpolated(state_matrix: Callable[[Array], Array], count: int) -> _Matrices:
    """Over the whole box, where that agrees with the loop's own matrix at drawn points; so many points along each
    parameter as a line through the first of them asks for."""
    drawn = np.random.default_rng(1).uniform(-1, 1, (4 + 4 * count, count))
    own = np.array([state_matrix(d) for d in drawn])
    unit = np.asarray(linalg.matrix_balance(np.abs(own).max(axis=0), permute=False, separate=True)[1][0])
    ratio = unit / unit[:, None]
    size = float(np.linalg.norm(own * ratio, axis=(1, 2)).max())

    def agrees(found: Array, wanted: Array) -> bool:
        return float(np.linalg.norm((found - wanted) * ratio, axis=(1, 2)).max()) <= AGREES * size

    asked = []  # places in NUMBERS
    for axis in range(count):
        line = np.tile(drawn[0], (len(drawn), 1))
        line[:, axis] = drawn[:, axis]
        wanted = np.array([state_matrix(d) for d in line])
        for m in NUMBERS:
            x, to_series = _points(m)
            on = np.tile(drawn[0], (m, 1))
            on[:, axis] = x
            series = np.tensordot(to_series, np.array([state_matrix(d) for d in on]), axes=1)
            if agrees(np.tensordot(np.polynomial.chebyshev.chebvander(line[:, axis], m - 1), series, axes=1), wanted):
                break
        asked.append(NUMBERS.index(m))
    for more in range(TRIES):  # elsewhere than on those lines it may take more
        numbers = [NUMBERS[min(place + more, len(NUMBERS) - 1)] for place in asked]
        if np.prod(numbers) > MOST_POINTS:
            break
        every = np.array([state_matrix(np.array(d)) for d in product(*(_points(m)[0] for m in numbers))])
        series = _along([_points(m)[1] for m in numbers], every.reshape(*numbers, *own.shape[1:]))
        found = _Matrices(state_matrix, series)
        if agrees(found.at(drawn), own):
            return found
    return _Matrices(state_matrix, None)

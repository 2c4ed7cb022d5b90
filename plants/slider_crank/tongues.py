"""Tongues of a slider-crank: the intervals of crank speed in which its cycle is unstable, found where they can be.

A rod's parametric resonances lie near W = (omega_i +- omega_j)/k, omega_i its frequencies with the crank fixed. About
each such speed, and between the speeds of a raster, the growth of the worst deviation is climbed by golden sections; a
peak above zero has its two edges found by bisection on the multipliers. What a raster steps over is so found too.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_instance, require_number
from pliant.plants.core.errors import EquilibriumError

from .plant import SliderCrank
from .steady_cycles import UNSTABLE, floquet_multipliers, steady_cycle

GOLDEN = (np.sqrt(5) - 1) / 2
NEAR = 0.03  # of a candidate's speed: how far its peak may lie from it
CLIMBS = 14  # golden sections: 1e-3 of the interval
MOST_STEPS = 60


class Tongue(NamedTuple):
    """An interval of crank speed [rad/s] with the largest growth in it."""

    low: float
    high: float
    peak: float  # [rad/s]
    growth: float  # [1/s] at the peak


def tongues(
    plant: SliderCrank,
    slowest: float,
    fastest: float,
    *,
    tolerance: float = 1e-4,
    raster: int = 24,
    orders: int = 3,
    points: int = 181,
) -> tuple[Tongue, ...]:
    """Those within [slowest, fastest] [rad/s]; edges to `tolerance` [rad/s], below 1 rad/s of the speed.

    `raster`: speeds to begin with; `orders`: the largest k. One that reaches over an end is cut there. A tongue that no
    candidate and no rise between two speeds of the raster hints at may be missed.
    Example: `tongues(SliderCrank.textbook(), 100.0, 400.0)`
    """
    require_instance("tongues.plant", plant, SliderCrank)
    slowest = require_number("tongues.slowest", slowest, "positive", "rad/s")
    fastest = require_number("tongues.fastest", fastest, "positive", "rad/s")
    if not fastest > slowest:
        raise ValueError(f"tongues.fastest = {fastest:g} must be > slowest = {slowest:g} [rad/s]")
    tolerance = require_number("tongues.tolerance", tolerance, "positive", "rad/s")
    raster = require_count("tongues", "raster", raster, 2, 10_000)
    orders = require_count("tongues", "orders", orders, 1, 20)
    growth, frequencies = _growth(plant, slowest, points)
    near = [w for w in _candidates(frequencies, orders) if slowest < w < fastest]
    grid = np.linspace(slowest, fastest, raster)
    values = np.array([growth(float(w)) for w in grid])
    starts = [(w * (1 - NEAR), w * (1 + NEAR)) for w in near]
    rises = np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:])) + 1
    starts += [(float(grid[k - 1]), float(grid[k + 1])) for k in rises]
    peaks = [_climbed(growth, max(low, slowest), min(high, fastest)) for low, high in starts]
    peaks += [float(w) for w, value in zip(grid, values) if value > 0]
    found: list[Tongue] = []
    for peak in sorted(peaks, key=growth, reverse=True):
        if growth(peak) <= 0 or any(t.low <= peak <= t.high for t in found):
            continue
        low, high = (_edge(growth, peak, end, tolerance) for end in (slowest, fastest))
        found.append(Tongue(low, high, peak, growth(peak)))
    return tuple(sorted(found))


def _growth(plant: SliderCrank, speed: float, points: int) -> tuple[Callable[[float], float], np.ndarray]:
    """ln of the largest multiplier's size per second, less what does not count, by speed; and the rod's frequencies."""
    driven = plant if plant.crank_speed is not None else dataclasses.replace(plant, crank_speed=speed)
    if driven.nx == 2:
        raise ValueError(f"tongues.plant is {driven.label}: its rod has no deviations")
    n = driven.coordinates_slice.stop
    kept = [s.name for i, s in enumerate(driven.states) if i not in (0, n)]
    rows = [i for i in range(driven.nx) if i not in (0, n)]

    @lru_cache(maxsize=4096)
    def growth(w: float) -> float:
        try:
            cycle = steady_cycle(driven, speed=w, points=points)
        except EquilibriumError:
            return -np.inf
        size = float(np.abs(floquet_multipliers(driven.linearize_along(cycle), kept)[0]))
        return float(np.log(size / (1 + UNSTABLE)) * w / (2 * np.pi))

    A = driven.linearize_along(steady_cycle(driven, speed=speed, points=points)).A.mean(axis=0)[np.ix_(rows, rows)]
    lam = np.linalg.eigvals(A).imag
    return growth, np.sort(lam[lam > 0])


def _candidates(frequencies: np.ndarray, orders: int) -> list[float]:
    both = [(a, b) for i, a in enumerate(frequencies) for b in frequencies[i:]]
    sums = {round(float((a + b) / k), 9) for a, b in both for k in range(1, orders + 1)}
    differences = {round(float((b - a) / k), 9) for a, b in both for k in range(1, orders + 1) if b > a}
    return sorted(sums | differences)


def _climbed(growth: Callable[[float], float], low: float, high: float) -> float:
    """The speed of a local maximum of growth within [low, high]."""
    inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
    for _ in range(CLIMBS):
        if growth(inner[0]) > growth(inner[1]):
            high, inner = inner[1], [inner[1] - GOLDEN * (inner[1] - low), inner[0]]
        else:
            low, inner = inner[0], [inner[1], inner[0] + GOLDEN * (high - inner[0])]
    return max(inner, key=growth)


def _edge(growth: Callable[[float], float], inside: float, end: float, tolerance: float) -> float:
    """Where growth ends between `inside` and the end of the range: steps that double, then bisection."""
    sign, step, stable = np.sign(end - inside), tolerance, inside
    for _ in range(MOST_STEPS):
        stable = inside + sign * step
        if sign * (stable - end) >= 0:
            stable = end
            if growth(end) > 0:
                return end
            break
        if growth(stable) <= 0:
            break
        inside, step = stable, 2 * step
    while abs(stable - inside) > tolerance * min(1.0, abs(inside)) / 2:
        middle = (stable + inside) / 2
        inside, stable = (middle, stable) if growth(middle) > 0 else (inside, middle)
    return float((inside + stable) / 2)

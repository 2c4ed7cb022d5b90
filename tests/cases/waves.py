"""Waves of period 1 with corners that are known, and nodes to see them at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass
class Wave:
    name: str
    f: Callable[[np.ndarray], np.ndarray]
    corners: tuple[float, ...] = ()  # within [0, 1): jumps and kinks
    steps: bool = False  # constant between the corners


def wave(rng: np.random.Generator) -> Wave:
    kind = rng.choice(["cos", "hill", "sharp", "square", "levels", "saw", "triangle", "rectified", "trapezoid"])
    p = float(rng.choice([0.0, rng.uniform()]))
    d = float(rng.choice([0.5, rng.uniform(0.15, 0.85)]))

    def phase(t: np.ndarray) -> np.ndarray:
        return np.mod(np.asarray(t, float) + p + 1e-12, 1.0)

    first, second = (-p) % 1.0, (d - p) % 1.0
    if kind == "cos":
        return Wave(kind, lambda t: np.cos(2 * np.pi * (t + p)))
    if kind == "hill":
        a, b = rng.standard_normal((2, 4)) / np.arange(1, 5)
        k = 2 * np.pi * np.arange(1, 5)
        return Wave(kind, lambda t: np.cos(np.multiply.outer(t, k)) @ a + np.sin(np.multiply.outer(t, k)) @ b)
    if kind == "sharp":
        s = rng.uniform(0.5, 2.5)
        return Wave(kind, lambda t: np.exp(s * np.sin(2 * np.pi * (t + p)) - s))
    if kind == "square":
        return Wave(kind, lambda t: np.where(phase(t) < d, 1.0, -1.0), (first, second), True)
    if kind == "levels":
        count = int(rng.integers(3, 6))
        cuts = np.sort(rng.uniform(0, 1, count))
        values = rng.uniform(-1, 1, count)
        where = lambda t: np.searchsorted(cuts, np.mod(np.asarray(t, float) + 1e-12, 1.0), side="right") % count  # noqa: E731
        return Wave(kind, lambda t: values[where(t)], tuple(cuts), True)
    if kind == "saw":
        return Wave(kind, lambda t: 2 * phase(t) - 1, (first,))
    if kind == "triangle":
        return Wave(
            kind, lambda t: 2 * np.where(phase(t) < d, phase(t) / d, (1 - phase(t)) / (1 - d)) - 1, (first, second)
        )
    if kind == "rectified":
        return Wave(kind, lambda t: 2 * np.abs(np.sin(np.pi * (t + p))) - 1, (first,))
    s = rng.uniform(1.2, 4.0)
    at = np.arccos(np.array([1, -1]) / s) / (2 * np.pi)
    corners = tuple(sorted((float(c) - p) % 1.0 for a in at for c in (a, 1 - a)))
    return Wave("trapezoid", lambda t: np.clip(s * np.cos(2 * np.pi * (t + p)), -1, 1), corners)


def grid(rng: np.random.Generator, m: int) -> np.ndarray:
    """m intervals of [0, 1]: equidistant, graded or at random."""
    kind = rng.choice(3, p=[0.5, 0.25, 0.25])
    s = np.linspace(0.0, 1.0, m + 1)
    if kind == 1:
        s = s + rng.uniform(-0.9, 0.9) * np.sin(2 * np.pi * s) / (2 * np.pi)
    if kind == 2:
        s = np.r_[0.0, np.sort(rng.uniform(0, 1, m - 1)), 1.0]
        s = s if np.diff(s).min() > 1e-9 else np.linspace(0.0, 1.0, m + 1)
    return s


def seen(t: np.ndarray, corners: tuple[float, ...]) -> bool:
    """Whether each stretch between two corners holds a node, over the seam too."""
    if len(corners) < 2:
        return True
    c = np.sort(np.array(corners))
    held = np.searchsorted(c, t[:-1], side="right") % len(c)
    return len(np.unique(held)) == len(c)

"""How far the tip of the cantilever is from the truth over 3 s: one measure for every program."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

Array = np.ndarray
END = 3.0  # [s]
TIMES = np.linspace(0.0, END, 601)
COARSE, FINE = 3e-3, 1e-4  # errors allowed [m]
TRUTH = 1e-5  # a truth's distance from the reference at most [m]
REFERENCE = Path(__file__).parents[2] / "tests" / "reference" / "large_beam.json"


def between(t: Array, y: Array, rate: Array, times: Array = TIMES) -> Array:
    """The cubic Hermite interpolant of y (n, k) with its rate at t (n,), at times (m,) -> (m, k)."""
    i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    h = (t[i + 1] - t[i])[:, None]
    s = (times - t[i])[:, None] / h
    near = (1 + 2 * s) * (1 - s) ** 2 * y[i] + s * (1 - s) ** 2 * h * rate[i]
    return np.asarray(near + s**2 * (3 - 2 * s) * y[i + 1] + s**2 * (s - 1) * h * rate[i + 1])


def away(tip: Array, truth: Array) -> float:
    """Largest distance [m]; infinite where a run broke down."""
    return float(np.linalg.norm(tip - truth, axis=1).max()) if np.isfinite(tip).all() else np.inf


def checked(tip: Array, theory: str) -> Array:
    """A truth (601, 2), or FloatingPointError where it is not the reference's."""
    for row in json.loads(REFERENCE.read_text())["release"][theory]:
        off = np.abs(tip[round(row["t"] / TIMES[1])] - [row["u"], row["v"]]).max()
        if not off <= TRUTH:
            raise FloatingPointError(f"cantilever: {theory} is {off:.2g} m off at {row['t']} s, allowed {TRUTH:g} m")
    return tip

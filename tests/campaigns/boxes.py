"""Bounds over boxes of parameters of random loops: a seeded campaign.

    python tests/campaigns/boxes.py

Frames of 2 to 3 masses whose masses, springs and dampers depend on 2 or 3 parameters. Wrong: a loop within the box that
was shown to be stable grows (random points and edges), or the worst parameters are not at the limit. Told: how far the
bounds are apart.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import numpy as np

from pliant.controllers.robust_analysis.nearest_instability import growth
from pliant.controllers.robust_analysis.robust_stability import RobustStability, over_box

TRIED = 10_000


def tried_out(
    found: RobustStability, state_matrix: Any, dt: float | None, rng: np.random.Generator, tried: int
) -> tuple[float, float]:
    """Largest growth [1/s] in the box that was shown, at random points and edges; |growth| at the worst parameters of a
    box (1, 3) for each."""
    d = rng.uniform(-1, 1, (tried, len(found.box)))
    d[::2] /= np.abs(d[::2]).max(axis=1, keepdims=True)
    grows = max(growth(state_matrix(found.stable_to * s), dt) for s in d)
    at = 0.0
    if found.worst is not None:
        at = abs(growth(state_matrix(np.array(list(found.worst.values())) - 2), dt))
    return grows, at


def run(seed: int, tried: int = TRIED) -> dict[str, Any]:
    began, rng = time.perf_counter(), np.random.default_rng(seed)
    n, k = int(rng.integers(2, 4)), int(rng.integers(2, 4))
    K0, D0 = np.diag(rng.uniform(1, 20, n)), np.diag(rng.uniform(0.05, 0.5, n))
    masses, springs = (rng.normal(size=(k, n)) for _ in range(2))
    follow = rng.normal(size=(n, n)) * 0.2  # a force that is no spring: what may grow

    def mass(d: np.ndarray) -> np.ndarray:
        wide = np.eye(2 * n)
        wide[n:, n:] += sum(0.1 * d[i] * np.outer(masses[i], masses[i]) / (masses[i] @ masses[i]) for i in range(k))
        return wide

    def state_matrix(d: np.ndarray) -> np.ndarray:
        K = K0 + follow + sum(0.6 * d[i] * np.outer(springs[i], springs[(i + 1) % k]) for i in range(k))
        A = np.zeros((2 * n, 2 * n))
        A[:n, n:], A[n:, :n], A[n:, n:] = np.eye(n), -K, -D0
        return np.linalg.solve(mass(d), A)

    row: dict[str, Any] = {"seed": seed, "states": 2 * n, "parameters": k}
    if growth(state_matrix(np.zeros(k)), None) >= -1e-3:
        return {**row, "gap": None, "wrong": False, "seconds": 0.0}
    found = over_box(state_matrix, {f"p{i}": (1.0, 3.0) for i in range(k)}, mass=mass)
    grows, at = tried_out(found, state_matrix, None, rng, tried)
    gap = None if found.unstable_at is None else found.mu[1] / found.mu[0] - 1
    wrong = bool((found.stable_to > 0 and grows > 0) or at > 1e-6)
    seconds = round(time.perf_counter() - began, 2)
    return {**row, "gap": gap, "grows": float(grows), "at": float(at), "wrong": wrong, "seconds": seconds}


def summary(rows: list[dict[str, Any]]) -> str:
    gaps = np.array([r["gap"] for r in rows if r["gap"] is not None])
    return (
        f"{len(rows)} loops: {sum(r['wrong'] for r in rows)} wrong; of {len(gaps)} that end in what was looked at the "
        f"bounds are within {np.median(gaps):.1%} in half, 2 % in {(gaps < 0.0205).sum()}, {gaps.max():.0%} at most"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 40, run, summary, lambda row: row["wrong"])

"""Bounds over boxes of parameters of random sampled loops: a seeded campaign.

    python tests/campaigns/sampled_boxes.py

Frames of 2 to 3 masses, sampled with held inputs, under LQR and under an observer with it, whose springs, masses and
dampers depend on 1 to 3 parameters. Wrong: a loop within the box that was shown to be stable grows (random points and
edges), or the worst parameters are not at the limit. Told: how far the bounds are apart.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import numpy as np
from boxes import tried_out
from scipy.linalg import expm, solve_discrete_are

from pliant.controllers.robust_analysis.robust_stability import over_box
from pliant.plants.core.errors import PliantError

TRIED = 5_000


def loop(rng: np.random.Generator) -> tuple[Any, int, float]:
    """(state_matrix, parameters, dt)."""
    n, k, dt = int(rng.integers(2, 4)), int(rng.integers(1, 4)), float(rng.choice([0.02, 0.1, 0.3]))
    M0, K0, D0 = np.diag(rng.uniform(0.5, 2, n)), rng.uniform(1, 40, n), rng.uniform(0.0, 0.2, n)
    which, share = rng.integers(0, 3, k), rng.uniform(0.1, 0.5, k)
    at = rng.integers(0, n, k)

    def plant(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        M, K, D = M0.copy(), K0.copy(), D0.copy()
        for i in range(k):
            if which[i] == 0:
                M[at[i], at[i]] *= 1 + share[i] * d[i]
            elif which[i] == 1:
                K[at[i]] *= 1 + share[i] * d[i]
            else:
                D[at[i]] += 0.3 * share[i] * d[i]
        chain = np.diag(K) + sum(K[j] * np.outer(e, e) for j, e in enumerate(np.diff(np.eye(n), axis=0)))
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, chain), -np.linalg.solve(M, np.diag(D))]])
        B = np.concatenate([np.zeros(n), np.linalg.solve(M, np.eye(n)[0])])[:, None]
        both = expm(np.block([[A, B], [np.zeros((1, 2 * n + 1))]]) * dt)
        return both[: 2 * n, : 2 * n], both[: 2 * n, 2 * n :]

    Ad, Bd = plant(np.zeros(k))
    Q = np.diag(10.0 ** rng.uniform(-1, 2, 2 * n))
    P = solve_discrete_are(Ad, Bd, Q, np.eye(1))
    K = np.linalg.solve(np.eye(1) + Bd.T @ P @ Bd, Bd.T @ P @ Ad)
    if rng.random() < 0.5:
        return (lambda d: np.subtract(*(lambda A, B: (A, B @ K))(*plant(d)))), k, dt
    C = np.eye(2 * n)[[int(rng.integers(n))]]
    S = solve_discrete_are(Ad.T, C.T, np.eye(2 * n), np.eye(1))
    L = Ad @ S @ C.T @ np.linalg.inv(C @ S @ C.T + np.eye(1))

    def observed(d: np.ndarray) -> np.ndarray:
        A, B = plant(d)
        return np.block([[A, -B @ K], [L @ C, Ad - Bd @ K - L @ C]])

    return observed, k, dt


def run(seed: int, tried: int = TRIED) -> dict[str, Any]:
    began, rng = time.process_time(), np.random.default_rng(seed)
    state_matrix, k, dt = loop(rng)
    row: dict[str, Any] = {"seed": seed, "states": len(state_matrix(np.zeros(k))), "parameters": k}
    try:
        found = over_box(state_matrix, {f"p{i}": (1.0, 3.0) for i in range(k)}, dt)
    except PliantError:  # not stable in the middle
        return {**row, "gap": None, "wrong": False, "seconds": 0.0}
    grows, at = tried_out(found, state_matrix, dt, rng, tried)
    gap = (found.most if found.unstable_at is None else found.unstable_at) / max(found.stable_to, 1e-9) - 1
    wrong = bool((found.stable_to > 0 and grows > 0) or at * dt > 1e-6)
    seconds = round(time.process_time() - began, 2)
    return {**row, "gap": gap, "grows": float(grows), "at": float(at), "wrong": wrong, "seconds": seconds}


def summary(rows: list[dict[str, Any]]) -> str:
    gaps = np.array([r["gap"] for r in rows if r["gap"] is not None])
    return (
        f"{len(rows)} loops: {sum(r['wrong'] for r in rows)} wrong; what is shown and what is unstable, or was looked "
        f"at, are within {np.median(gaps):.1%} in half, within 2 % in {(gaps < 0.0205).sum()} of {len(gaps)}, "
        f"{gaps.max():.0%} at most"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 40, run, summary, lambda row: row["wrong"])

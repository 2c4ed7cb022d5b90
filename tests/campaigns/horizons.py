"""Numbers of finite horizons of random LTV systems: a seeded campaign.

    python tests/campaigns/horizons.py

Whether the bounds of the energy gain meet within 1 %, whether the disturbances that are returned attain what is told
when the model itself plays them, and whether none of 20 random disturbances of the same size gets further.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import numpy as np
from horizon_models import random_ltv

from pliant.plants.finite_horizon import finite_horizon

MET = 1e-6  # relative


def run(seed: int) -> dict[str, Any]:
    began, model, rng = time.perf_counter(), random_ltv(seed), np.random.default_rng(seed)
    found = finite_horizon(model)
    start, h = np.zeros(model.A.shape[1]), np.diff(model.t)[:, None]

    def played(w: np.ndarray) -> np.ndarray:
        return np.asarray(model.simulate(start, None, w)[1])

    missed = 0.0
    for name, push in (*found.peak.items(), *found.end.items(), *found.bounded.items()):
        at, row = int(np.flatnonzero(model.t == push.time)[0]), model.output_names.index(name)
        missed = max(missed, abs(played(push.disturbance)[at, row] / push.lower - 1))
    beyond = 0.0
    for k in range(20):
        w = rng.normal(size=(len(model.t), len(model.disturbances)))
        if k % 2:
            w = np.cumsum(w, axis=0)
        small = w / np.sqrt((np.square(w[:-1]) * h).sum())
        z = played(np.vstack([small[:-1], np.zeros((1, w.shape[1]))]))
        direct = np.abs(model.F).max(axis=(0, 2)) > 0
        for i, push in enumerate(found.peak.values()):
            beyond = max(beyond, 0.0 if direct[i] else float(np.abs(z[:, i]).max() / push.upper))
        z = played(w / np.abs(w).max())
        beyond = max(beyond, max(float(np.abs(z[:, i]).max() / p.upper) for i, p in enumerate(found.bounded.values())))
    pushed = (*found.bounded.values(), *found.peak.values(), *found.end.values())
    gaps = [p.upper / p.lower - 1 for p in pushed if np.isfinite(p.upper)]
    row = {"seed": seed, "states": model.A.shape[1], "gap": found.l2.gap, "widest": max(gaps)}
    wrong = missed > MET or beyond > 1.0 or not row["gap"] <= 0.01 or row["widest"] > 0.01
    seconds = round(time.perf_counter() - began, 3)
    return {**row, "missed": missed, "beyond": beyond, "wrong": bool(wrong), "seconds": seconds}


def summary(rows: list[dict[str, Any]]) -> str:
    return (
        f"{len(rows)} systems: {sum(r['wrong'] for r in rows)} wrong; bounds of the energy gain within "
        f"{max(r['gap'] for r in rows):.2%}, of outputs within {max(r['widest'] for r in rows):.2%}, attained to "
        f"{max(r['missed'] for r in rows):.1e}, random disturbances reach {max(r['beyond'] for r in rows):.2f}"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 200, run, summary, lambda row: row["wrong"])

"""Laws for models that conserve something, and leave something free: a seeded campaign.

    python tests/campaigns/conserved.py

A hub or a chain of masses in random coordinates and units, turned by more or fewer wheels than it needs, or free in
space. The truth is that of the part that inputs steer, known before the coordinates are mixed: SciPy's Riccati solution
of it, its poles, how many quantities are conserved and free. Counted are wrong costs, wrong poles, wrong counts, and
weighed quantities that are not refused.
"""

from __future__ import annotations

from typing import Any

import by_seed
import numpy as np
from scipy.linalg import solve_continuous_are

from pliant.controllers import LQR, loop
from pliant.plants import LinearModel, UncontrollableError


def run(seed: int) -> dict[str, Any]:
    """One model: states [steered (n); stores that only inputs change, of which some combinations are conserved]."""
    rng = np.random.default_rng(seed)
    n, nu, stores = int(rng.integers(2, 7)), int(rng.integers(1, 4)), int(rng.integers(1, 5))
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, nu))
    given = rng.normal(size=(stores, nu))  # what inputs put into the stores, one row each
    wide = np.block([[A, np.zeros((n, stores))], [np.zeros((stores, n + stores))]])
    push = np.vstack([B, given])
    scale = 10.0 ** rng.uniform(-4, 4, n + stores)
    turn = np.eye(n + stores)
    turn[:n, :n] += 0.3 * rng.normal(size=(n, n))  # only inputs change the stores, whatever the others are called
    mix = scale[:, None] * turn
    back = np.linalg.inv(mix)
    model = LinearModel.from_matrices(mix @ wide @ back, mix @ push)
    C = rng.normal(size=(n, n))
    Q = np.zeros((n + stores, n + stores))
    Q[:n, :n] = C.T @ C + 0.1 * np.eye(n)
    R = np.diag(rng.uniform(0.5, 2.0, nu))
    row: dict[str, Any] = {"seed": seed, "fault": ""}
    # A steered part of full rank: w = (w1, w2) with w1 A = 0 has w1 = 0, so that w2 given = 0 is all that is conserved
    kept = stores - int(np.linalg.matrix_rank(given))
    law = LQR.design(model, back.T @ Q @ back, R)
    P = solve_continuous_are(A, B, Q[:n, :n], R)
    x = np.append(rng.normal(size=n), rng.normal(size=stores))
    cost = x[:n] @ P @ x[:n]
    poles = np.linalg.eigvals(A - B @ np.linalg.solve(R, B.T @ P))
    if abs(law.cost_to_go(mix @ x) - cost) > 1e-6 * cost:
        row["fault"] = "cost"
    elif len(law.poles) != n or max(np.abs(law.poles - z).min() for z in poles) > 1e-5 * np.abs(poles).max():
        row["fault"] = "poles"
    elif (len(law.conserved), len(law.free)) != (kept, stores - kept):
        row["fault"] = "counts"
    elif np.linalg.eigvals(loop(model, law).closed()).real.max() >= 0:
        row["fault"] = "loop"
    elif kept:
        Q[n:, n:] = np.eye(stores)
        try:
            LQR.design(model, back.T @ Q @ back, R)
            row["fault"] = "not refused"
        except UncontrollableError:
            pass
    return row


def summary(rows: list[dict[str, Any]]) -> str:
    found = {kind: sum(r["fault"] == kind for r in rows) for kind in ("cost", "poles", "counts", "loop", "not refused")}
    return f"{len(rows)} models; " + ", ".join(f"{kind}: {count}" for kind, count in found.items())


def faulty(row: dict[str, Any]) -> bool:
    return bool(row["fault"])


if __name__ == "__main__":
    by_seed.main(__doc__ or "", 1000, run, summary, faulty)

"""How dear a soft limit must be so that it is exceeded only where it cannot be kept.

A linear price above the largest multiplier of the problem with hard limits leaves its solution as it is: "Soft
Constraints and Exact Penalty Functions in Model Predictive Control" (Kerrigan and Maciejowski 2000). The largest
over all states is itself hard to find; here it is taken over states that random inputs within the limits reach, and
the same nearer to the reference, since far ones may have no input that keeps the bounded signals in theirs.
"""

from __future__ import annotations

import numpy as np

from .constraints import Step

MARGIN = 10.0  # price against the largest multiplier found
SAMPLES = 60
HALVINGS = 8  # scales at which each drawn state is tried: far ones may have no solution under hard limits


def sufficient_penalty(
    hard: Step, A: np.ndarray, B: np.ndarray, p: np.ndarray, low: np.ndarray, high: np.ndarray, root: np.ndarray
) -> float:
    """Price of |z|^2 per unit of a row. A (nx, nx), B (nx, nu) of one step, `p` at the reference, whose first nx are
    the state; low, high (nu,) inputs less their reference; root (nu, nu) scales those without limits.
    """
    soft = hard.names >= 0
    if not soft.any():
        return 0.0
    rng = np.random.default_rng(0)
    nx, nu = B.shape
    m = len(hard.low)
    horizon = len(hard.plan[0])
    free = np.linalg.inv(root)
    largest = 0.0
    for _ in range(SAMPLES):
        xi = np.zeros(nx)
        for _ in range(rng.integers(1, 3 * horizon)):
            drawn = free @ rng.standard_normal(nu)
            ends = np.where(rng.random(nu) < 0.5, low, high)
            xi = A @ xi + B @ np.where(np.isfinite(ends), ends, drawn)
        for k in range(HALVINGS):
            at = p.copy()
            at[:nx] += xi / 2**k
            d = hard.G[:m] @ at
            if hard.solver.solve(hard.low - d, hard.high - d) is not None:
                largest = max(largest, float(np.abs(hard.solver.multipliers[soft]).max()))
    if largest == 0.0:
        largest = float(np.median(1 / np.maximum(np.square(hard.solver.M[soft]).sum(axis=1), 1e-12)))
    return MARGIN * 2 * largest

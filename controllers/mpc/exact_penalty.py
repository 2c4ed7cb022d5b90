"""A soft limit is exceeded only where no plan keeps them all: a price, and where that is too low, hard limits.

A linear price above the largest multiplier of the problem with hard limits leaves its solution as it is: "Soft
Constraints and Exact Penalty Functions in Model Predictive Control" (Kerrigan and Maciejowski 2000). The largest
over all states is itself hard to find; the price is taken over states that random inputs within the limits reach, and
the same nearer to the reference, since far ones may have no input that keeps the bounded signals in theirs.

That is a sample, not a proof: other states need more. So a plan that exceeds a limit at this price is made again with
all limits hard (`WithoutExcess`). If that has a solution it is the plan; if not, no plan within the horizon keeps them
all, and the one at the price stands: what it exceeds is not shown to be the least.
"""

from __future__ import annotations

from typing import final

import numpy as np

from pliant.controllers.base.solver_record import Record
from pliant.controllers.solvers.least_distance_qp import LeastDistance
from pliant.plants.core.signals import OwnsArrays

from .constraints import Step, excess

MARGIN = 10.0  # price against the largest multiplier found
SAMPLES = 60
SLACK = 1e-7  # of half a range: what a state may be outside by rounding and still count as inside
HALVINGS = 8  # scales at which each drawn state is tried: far ones may have no solution under hard limits


def sufficient_penalty(
    hard: Step, A: np.ndarray, B: np.ndarray, p: np.ndarray, low: np.ndarray, high: np.ndarray, root: np.ndarray
) -> float:
    """Price of |z|^2 per unit of a row, enough for the states that are sampled.

    A (nx, nx), B (nx, nu) of one step, `p` at the reference, whose first nx are the state; low, high (nu,) inputs less
    their reference; root (nu, nu) scales those without limits.
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


@final
class WithoutExcess(OwnsArrays):
    """The plan of a step with every limit hard. Its solver is made when it is first needed."""

    def __init__(self) -> None:
        self._solvers: dict[int, LeastDistance] = {}
        self.multipliers = np.zeros(0)  # of the rows in the last plan
        self.widened = False  # whether it needed SLACK

    def forget(self) -> None:
        """Start again from no active set."""
        self._solvers.clear()

    def plan(self, at: int, step: Step, lower: np.ndarray, upper: np.ndarray) -> np.ndarray | None:
        """z (nz,) of the step with index `at`, under lower, upper (m,); None where no plan keeps them.

        Where there is none, soft limits are widened by SLACK once, for a state that is outside by rounding alone.
        """
        solver = self._solvers.get(at)
        if solver is None:
            solver = self._solvers[at] = LeastDistance(step.solver.M, np.zeros(len(lower), dtype=bool), 0.0)
        z = solver.solve(lower, upper)
        self.widened = z is None
        if z is None:
            wider = SLACK * step.solver.soft
            z = solver.solve(lower - wider, upper + wider)
        self.multipliers = solver.multipliers
        return z


def kept(
    firm: WithoutExcess | None,
    at: int,
    step: Step,
    z: np.ndarray,
    bounds: tuple[np.ndarray, np.ndarray],
    record: Record,
) -> tuple[np.ndarray, np.ndarray]:
    """The plan without excess in place of z (nz,), where there is one, and its multipliers (m,); `record` notes the
    excess that stays."""
    hard = None if firm is None else firm.plan(at, step, *bounds)
    multipliers = step.solver.multipliers
    if firm is not None and hard is not None:
        z, multipliers = hard, firm.multipliers
    beyond = excess(step, z, *bounds, len(record.names))
    within = firm is not None and hard is not None and not firm.widened
    if not within:
        record.violate(beyond)
    return z, multipliers

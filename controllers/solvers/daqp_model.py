"""One quadratic program in DAQP, solved again and again from the active set of the last solution.

min 1/2 d'H d + f'd + sum_i w_i (s_i + CURVATURE s_i^2 / 2)   over d (n,) and s >= 0, with
lower - s <= [d; A d] <= upper + s, the first bounds on variables where A has fewer rows than there are bounds; s_i = 0
where row i is hard.

A dual active-set method (Arnstrom, Bemporad, Axehill, "A dual active-set solver for embedded quadratic programming
using recursive LDL' updates", 2022). H and A are factorised when they are given; new bounds and f cost little. A solve
that fails from the last active set is tried once more from none.
"""

from __future__ import annotations

from typing import final

import numpy as np

Array = np.ndarray
INFINITE = 1e30  # a bound that DAQP takes for none
SOFT, ACTIVE, AT_LOWER = 8, 1, 2  # DAQP's marks of a row
VIOLATED = 2  # DAQP's exit flag: optimal, a soft row is violated
CURVATURE = 1e-3  # quadratic part of the price of a violation, which DAQP needs, at a violation of one
WORDS = {
    -1: "infeasible",
    -2: "the active set cycles",
    -3: "unbounded",
    -4: "iteration limit",
    -5: "not convex",
    -6: "too many equalities",
}


@final
class DaqpModel:
    """H (n, n) > 0, f (n,), A (rows, n), sense: DAQP's mark of each bound (m,). DAQP is imported with the first one."""

    def __init__(
        self, H: Array, f: Array, A: Array, sense: Array, *, far: float, tolerance: float, iteration_limit: int
    ) -> None:
        """Bounds are +-far until `update` sets others; tolerance: violation of a bound that passes for none."""
        import daqp

        self.sense = sense  # marks without active rows
        self._solver = daqp.Model()
        self._solver.settings = {"primal_tol": tolerance, "iter_limit": iteration_limit}
        bounds = np.full(len(sense), far)
        self.flag, _ = self._solver.setup(H, f, A, bounds, -bounds, sense.copy())
        self.iterations = 0
        self.multipliers = np.zeros(len(sense))  # of the last solution, positive at upper bounds

    def price(self, w: float) -> None:
        """What a unit of violation of each soft row costs."""
        weights = np.full(len(self.sense), w)
        rho = 1 / (CURVATURE * weights)
        self._solver.soft_weights(rho, rho, weights, weights)

    def update(self, **parts: Array) -> bool:
        """Take new H, A, f, bupper, blower or sense, kept by reference; False where DAQP refuses them."""
        self.flag, self.iterations = self._solver.update(**parts), 0
        return self.flag >= 0

    def forget(self) -> None:
        """Start the next solve from no active set."""
        if len(self.sense):
            self._solver.update(sense=self.sense)

    def solve(self) -> Array | None:
        """d (n,), None where there is none or it is not found; `flag`, `iterations`, `multipliers` say more."""
        d, _, self.flag, info = self._solver.solve()
        self.iterations = info["iterations"]
        if self.flag <= 0 and self._solver.update(sense=self.sense) >= 0:
            d, _, self.flag, info = self._solver.solve()
            self.iterations += info["iterations"]
        if self.flag <= 0:
            return None
        self.multipliers = info["lam"]
        return d

    @property
    def violated(self) -> bool:
        """Whether the last solution violates a soft row."""
        return self.flag == VIOLATED

"""The recursion over stages against the normal equations of the same horizon, condensed."""

import numpy as np
import pytest

from pliant.controllers.nmpc.condensing import Condensed
from pliant.controllers.nmpc.stage_recursion import StageRecursion


@pytest.mark.parametrize(("N", "nl"), [(1, 3), (4, 0), (7, 4), (30, 1)])
def test_is_the_least_cost_of_the_condensed_horizon(N: int, nl: int) -> None:
    rng = np.random.default_rng(N)
    nx, nu, nr = 3, 2, 4
    horizon = Condensed(N, nx, nu, nr, 0, rng.standard_normal((nl, nx)))
    recursion = StageRecursion(horizon)
    for _ in range(2):  # the second time on used arrays
        for stages in (horizon.dynamics, horizon.residual):
            stages[:] = rng.standard_normal(stages.shape)
        horizon.dynamics[:, :, :nx] *= 0.6
        horizon.finish(rng.standard_normal(nx))
        horizon.form()
        assert recursion.factor()
        e = rng.standard_normal(nx)
        dx, d = recursion.solve(e)
        want = -np.linalg.solve(horizon.H, horizon.F @ e + horizon.f0)
        np.testing.assert_allclose(d, want, rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(dx, horizon.states(e, d), rtol=1e-9, atol=1e-10)


def test_what_is_not_finite_or_has_no_price_is_refused() -> None:
    horizon = Condensed(3, 2, 1, 2, 0, np.eye(2))
    recursion = StageRecursion(horizon)
    horizon.dynamics[:] = horizon.residual[:] = 1.0
    horizon.finish(np.ones(2))
    assert recursion.factor()
    horizon.residual[1, 0, 0] = np.nan
    assert not recursion.factor()
    horizon.residual[:] = 0.0
    horizon.dynamics[:, :, 3] = 0.0  # inputs that neither cost nor act
    assert not recursion.factor()

"""A condensed horizon against the same stages walked through one by one."""

import numpy as np
import pytest

from pliant.controllers.nmpc import condensing
from pliant.controllers.nmpc.condensing import Condensed


@pytest.mark.parametrize("long", [0, 100])
@pytest.mark.parametrize(("N", "nb", "nl"), [(1, 2, 3), (4, 0, 3), (5, 2, 0), (7, 3, 4)])
def test_equals_the_stages_walked_through(N: int, nb: int, nl: int, long: int, monkeypatch) -> None:
    monkeypatch.setattr(condensing, "LONG", long)  # of few inputs as of many
    rng = np.random.default_rng(N)
    nx, nu, nr = 3, 2, 4
    L, end = rng.standard_normal((nl, nx)), rng.standard_normal(nx)
    problem = Condensed(N, nx, nu, nr, nb, L)
    for _ in range(2):  # the second time on used arrays
        for stages in (problem.dynamics, problem.residual, problem.bounded):
            stages[:] = rng.standard_normal(stages.shape)
        problem.finish(end)
        problem.form()
        e, d = rng.standard_normal(nx), rng.standard_normal(N * nu)

        def cost(d: np.ndarray, e: np.ndarray = e) -> tuple[float, list[np.ndarray], list[np.ndarray]]:
            dx, total, rows, walked = e, 0.0, [], [e]
            for k, du in enumerate(d.reshape(N, nu)):
                v = np.concatenate([dx, [1.0], du])
                total += np.sum((problem.residual[k] @ v) ** 2)
                rows.append(problem.bounded[k] @ v)
                dx = problem.dynamics[k] @ v
                walked.append(dx)
            return total + np.sum((L @ (dx + end)) ** 2), rows, walked

        full, rows, walked = cost(d)
        zero = cost(np.zeros(N * nu))[0]
        found = d @ problem.H @ d + 2 * (problem.F @ e + problem.f0) @ d
        assert found == pytest.approx(full - zero, rel=1e-10, abs=1e-10)
        assert problem.S[nx, nx] == pytest.approx(cost(np.zeros(N * nu), np.zeros(nx))[0], rel=1e-10)
        np.testing.assert_allclose(problem.S, problem.S.T, atol=1e-10 * np.abs(problem.S).max())
        np.testing.assert_allclose(problem.states(e, d), walked, rtol=1e-10, atol=1e-10)
        assert problem.unchanged() == pytest.approx(problem.S[nx, nx], rel=1e-10)
        dx = problem.states(e, d)
        np.testing.assert_allclose(problem.signals(dx, d), np.array(rows[1:]).reshape(-1), rtol=1e-10, atol=1e-10)
        z = problem.Zd @ d + problem.Ze @ e + problem.z0
        np.testing.assert_allclose(z, np.array(rows[1:]).reshape(-1), rtol=1e-10, atol=1e-10)

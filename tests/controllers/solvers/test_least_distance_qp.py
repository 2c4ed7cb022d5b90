"""Least distance to a half plane and to a box, in closed form; soft rows at a low and at an exact price."""

import pickle

import numpy as np
import pytest

from pliant.controllers.solvers.least_distance_qp import LeastDistance

FAR = np.array([1e30])


def test_foot_of_the_perpendicular():
    """min |z|^2 with 3 z1 + 4 z2 >= 10: z = 10 (3, 4)/25, multiplier of |z|^2/2 is -10/25 at the lower bound."""
    problem = LeastDistance([[3.0, 4.0]], [False], 0.0)
    for made in (problem, pickle.loads(pickle.dumps(problem))):
        assert made.solve(np.array([10.0]), FAR) == pytest.approx([1.2, 1.6])
        assert made.multipliers == pytest.approx([-0.4]) and not made.violated
    assert problem.solve(-FAR, np.array([-10.0])) == pytest.approx([-1.2, -1.6])
    assert problem.multipliers == pytest.approx([0.4])


def test_warm_starts_do_not_matter():
    rng = np.random.default_rng(1)
    M = rng.normal(size=(8, 4))
    one, other = LeastDistance(M, [False] * 8, 0.0), LeastDistance(M, [False] * 8, 0.0)
    marks = np.zeros(8)
    for _ in range(20):
        centre = M @ rng.normal(size=4)
        low, high = centre - 0.1, centre + 0.1
        cold = LeastDistance(M, [False] * 8, 0.0).solve(low, high)
        np.testing.assert_allclose(one.solve(low, high), cold, atol=1e-8)
        np.testing.assert_allclose(other.solve(low, high, marks), cold, atol=1e-8)
        marks = other.multipliers


def test_rows_that_contradict_each_other_have_no_solution():
    problem = LeastDistance([[1.0], [1.0]], [False, False], 0.0)
    assert problem.solve(np.array([1.0, -1e30]), np.array([1e30, -1.0])) is None and problem.flag < 0
    assert problem.solve(np.array([1.0, -1e30]), np.array([1e30, 2.0])) == pytest.approx([1.0])


@pytest.mark.parametrize(("penalty", "z"), [(0.5, 0.25), (10.0, 1.0)])
def test_a_soft_row_is_kept_where_its_price_is_above_its_multiplier(penalty, z):
    """min z^2 + p s, z >= 1 - s: z = p/2 below p = 2, above it the row holds; 1e-3 of a quadratic price beside."""
    problem = LeastDistance([[1.0]], [True], penalty)
    found = problem.solve(np.array([1.0]), FAR)
    assert found == pytest.approx([z], rel=2e-3) and problem.violated == (z < 1)

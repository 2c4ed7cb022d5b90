"""Least squares within bounds: published problems, bounds that hold, starts that are hopeless."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from pliant.plants.identification import bounded_least_squares
from pliant.plants.identification.bounded_least_squares import Linearised, minimise, within


def of(residual, jacobian, tried=None):
    def linearise(z):
        if tried is not None:
            tried.append(z.copy())
        r = residual(z)
        return Linearised(jacobian(z), r, 0.0) if np.isfinite(r).all() else None

    return linearise


def rosenbrock(z):
    return np.array([10 * (z[1] - z[0] ** 2), 1 - z[0]])


def slopes(z):
    return np.array([[-20 * z[0], 10.0], [-1.0, 0.0]])


FREE = np.full(2, np.inf)


def test_rosenbrocks_valley():
    """Moré, Garbow and Hillstrom 1981, problem 1: from (-1.2, 1) to (1, 1). What TOLERANCE leaves: |J s| <= 1e-3, and J
    at (1, 1) has the singular values 22.4 and 0.446."""
    found = minimise(of(rosenbrock, slopes), np.array([-1.2, 1.0]), -FREE, FREE)
    assert found.converged and np.abs(found.z - 1).max() < 1e-3 / 0.446 and found.at.cost < 1e-6


def test_powells_badly_scaled_function():
    """Moré, Garbow and Hillstrom 1981, problem 3: from (0, 1) to (1.098e-5, 9.106)."""

    def r(z):
        return np.array([1e4 * z[0] * z[1] - 1, np.exp(-z[0]) + np.exp(-z[1]) - 1.0001])

    def J(z):
        return np.array([[1e4 * z[1], 1e4 * z[0]], [-np.exp(-z[0]), -np.exp(-z[1])]])

    found = minimise(lambda z: Linearised(1e4 * J(z), 1e4 * r(z), 0.0), np.array([0.0, 1.0]), -FREE, FREE, most=500)
    assert found.converged and np.abs(found.z / [1.098e-5, 9.106] - 1).max() < 1e-3


def test_no_point_outside_the_bounds_is_tried():
    tried = []
    low, high = np.array([-2.0, -1.0]), np.array([0.8, 2.0])
    found = minimise(of(rosenbrock, slopes, tried), np.array([-1.2, 1.0]), low, high)
    assert all((z >= low).all() and (z <= high).all() for z in tried)
    assert np.abs(found.z - [0.8, 0.64]).max() < 1e-3 and found.converged


def test_steps_within_bounds_are_scipys():
    rng = np.random.default_rng(0)
    for _ in range(20):
        R, r = rng.normal(size=(6, 4)), rng.normal(size=6)
        low, high = -rng.uniform(0, 0.3, 4), rng.uniform(0, 0.3, 4)
        s = within(R, r, low, high)
        right = lsq_linear(R, -r, (low, high), method="trf", tol=1e-14).x
        assert np.linalg.norm(R @ s + r) <= np.linalg.norm(R @ right + r) + 1e-9
        assert (s >= low).all() and (s <= high).all()
    held = within(R, r, np.zeros(4), np.array([0.0, 1.0, 1.0, 1.0]))
    assert held[0] == 0.0


def test_where_nothing_is_finite_there_is_no_result_and_a_wall_is_kept_from():
    assert minimise(of(lambda z: np.array([np.nan, 0.0]), slopes), np.zeros(2), -FREE, FREE) is None

    def walled(z):
        return np.array([np.log(z[0]) if z[0] > 0 else np.nan, z[1]])

    found = minimise(of(walled, lambda z: np.array([[1 / z[0], 0.0], [0.0, 1.0]])), np.array([8.0, 1.0]), -FREE, FREE)
    assert found.converged and abs(found.z[0] - 1) < 1e-3


def test_a_direction_without_any_slope_stays_where_it_is():
    def r(z):
        return np.array([z[0] - 1.0, 0.0])

    found = minimise(of(r, lambda z: np.array([[1.0, 0.0], [0.0, 0.0]])), np.array([3.0, 5.0]), -FREE, FREE)
    assert found.converged and found.z[1] == 5.0 and abs(found.z[0] - 1) < 1e-3


def test_a_search_that_is_cut_says_so(monkeypatch):
    found = minimise(of(rosenbrock, slopes), np.array([-1.2, 1.0]), -FREE, FREE, most=3)
    assert not found.converged and found.evaluations == 3
    monkeypatch.setattr(bounded_least_squares, "STALLED", 0.0)
    seen = []
    minimise(of(rosenbrock, slopes), np.array([-1.2, 1.0]), -FREE, FREE, told=lambda used, cost: seen.append(cost))
    assert seen == sorted(seen, reverse=True) and len(seen) > 3


@pytest.mark.parametrize("cost", [1.0, 1e6])
def test_the_cost_holds_what_no_step_changes(cost):
    at = Linearised(np.eye(2), np.array([3.0, 4.0]), cost)
    assert at.cost == 12.5 + cost

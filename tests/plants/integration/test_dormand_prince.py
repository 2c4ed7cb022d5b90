"""Dormand and Prince's pair of order 8: closed forms, tolerances, SciPy's own steps, a motion that ends."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants import IntegrationError
from pliant.plants.integration.dormand_prince import march

W, P = np.zeros(1), np.zeros(0)
TIMES = np.linspace(0.0, 4.0, 9)


def run(plant, tolerance=1e-10, law=None, w=W):
    options = {"rtol": tolerance, "atol": tolerance, "first": 0.01, "audit": False}
    return march(plant, TIMES, np.array([1.0, 0.0]), np.zeros(1), law, w, P, **options)


def test_a_vibration_is_a_cosine_to_the_tolerance(vibration):
    exact = np.cos(3.0 * TIMES)
    errors = [np.abs(run(vibration, tolerance)[0][:, 0] - exact).max() for tolerance in (1e-6, 1e-9)]
    assert 1e-12 < errors[1] < 1e-7 and errors[1] < errors[0] / 50 < 1e-5


def test_steps_are_about_as_many_as_scipys(vibration):
    """The same pair with the same error norm; here steps also end on every time asked for."""
    scipys = solve_ivp(lambda t, x: [x[1], -9.0 * x[0]], (0, 4), [1.0, 0.0], "DOP853", rtol=1e-10, atol=1e-10)
    assert len(scipys.t) - 1 <= run(vibration)[1] <= len(scipys.t) + len(TIMES)


def test_an_input_of_time_is_taken_at_every_stage(vibration):
    """x'' = -9 x + 8 cos t from (1, 0) is x = cos t."""
    found = run(vibration, law=lambda t: 8.0 * np.cos(t))[0]
    np.testing.assert_allclose(found[:, 0], np.cos(TIMES), atol=1e-8)


def test_a_constant_disturbance_moves_the_rest(vibration):
    """x'' = -9 (x - 1): from (1, 0) nothing moves."""
    np.testing.assert_allclose(run(vibration, w=np.array([9.0]))[0], np.tile([1.0, 0.0], (9, 1)), atol=1e-12)


def test_it_stops_where_the_motion_ends(blowing):
    """1 / (1 - t) is infinite at 1 s."""
    with pytest.raises(IntegrationError, match="dop853 stopped at t = 1 s") as stopped:
        options = {"rtol": 1e-8, "atol": 1e-8, "first": 0.01, "audit": False}
        march(blowing, np.array([0.0, 2.0]), np.array([1.0]), np.zeros(1), None, np.zeros(0), P, **options)
    assert stopped.value.time == pytest.approx(1.0, abs=1e-6) and stopped.value.state.shape == (1,)

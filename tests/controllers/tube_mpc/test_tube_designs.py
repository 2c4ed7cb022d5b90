"""The ancillary law's cost: limits against each other, the scene's cost behind them."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are
from two_masses import GIVEN, LIMIT, MODEL, PUSH, Q, R, tube

from pliant.controllers import TubeMPC, riccati
from pliant.controllers.tube_mpc.error_bounds import tightening
from pliant.controllers.tube_mpc.tightened_steps import crowding
from pliant.controllers.tube_mpc.tube_designs import PRICES, SMALL, about_point, ancillary_cost


@pytest.fixture(scope="module")
def tubes():
    return about_point(MODEL, Q, R, 8, 0.1, (GIVEN["limits"], None, GIVEN["bounds"], 0, None), None)


def test_the_gain_is_that_of_signals_and_inputs_in_units_of_their_limits(tubes):
    """By SciPy's solver of the Riccati equation."""
    weight = SMALL * Q + np.diag([0, 0, 0, 1 / LIMIT**2])
    A, B, W, E, N = riccati.sampled(MODEL.A, MODEL.B, weight, np.array([[3.0]]), np.zeros((4, 1)), dt=0.1)
    P = solve_discrete_are(A, B, W, E, s=N)
    K = np.linalg.solve(E + B.T @ P @ B, B.T @ P @ A + N.T)
    np.testing.assert_allclose(tubes.courses[3.0].K[0], K, rtol=1e-7)


def test_an_input_without_limits_keeps_its_own_price(tubes):
    limits = tubes.made["limits"]
    open_ended = type(limits)(limits.inputs, *(np.array([e]) for e in (-np.inf, np.inf, np.inf)), (), *np.zeros((2, 0)))
    found = ancillary_cost(MODEL, Q, R, open_ended, 10.0)
    np.testing.assert_allclose(found[0], SMALL * Q)
    np.testing.assert_allclose(found[1], [[10.0 * SMALL * 0.1]])


def test_the_price_is_the_one_that_crowds_least(tubes):
    limits = tubes.made["limits"]
    found = {
        p: crowding(tightening(c, tubes.rows(p, 1), PUSH, 1), limits, tubes.origin) for p, c in tubes.courses.items()
    }
    assert tuple(found) == PRICES
    assert tube(horizon=8).price == min(found, key=lambda price: found[price])


def test_a_sampled_model_gives_the_same_tubes_for_the_same_weights():
    held = MODEL.discretize(0.1)
    given = {**GIVEN, "dt": None, "horizon": 6}
    A, _, W, E, _ = riccati.sampled(MODEL.A, MODEL.B, Q, np.array(R), np.zeros((4, 1)), dt=0.1)
    made = TubeMPC.design(held, W, E, PUSH, **given)
    np.testing.assert_allclose(made.course.A[0], A, atol=1e-12)
    assert made.dt == 0.1 and made.act(0.0, np.array([0.5, 0.5, 0, 0])).shape == (1,)

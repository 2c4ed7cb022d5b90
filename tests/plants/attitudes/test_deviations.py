"""Maps between states with quaternions and small deviations, against finite turns."""

import numpy as np
import pytest
from moved_states import moved

from pliant.plants.core.quaternions import product, quaternion


def test_back_undoes_forward(craft):
    x = np.array([moved(craft, seed) for seed in range(3)])
    T, L = craft.small.forward(x), craft.small.back(x)
    np.testing.assert_allclose(L @ T, np.broadcast_to(np.eye(craft.nx - 2), (3, 20, 20)), atol=1e-14)


def test_a_turn_is_a_small_rotation_in_the_axes_that_turn(craft):
    """q exp(turn/2) to first order: the error falls with the square."""
    x, turn = moved(craft, 1), np.array([0.3, -0.5, 0.2])
    (base, _) = craft.small.attitudes
    errors = []
    for h in (1e-3, 1e-4):
        xi = np.zeros(craft.small.n)
        xi[craft.small.turn(base)] = h * turn
        near = x[base.quaternion] + (craft.small.forward(x) @ xi)[base.quaternion]
        errors.append(np.abs(near - product(x[base.quaternion], quaternion(h * turn))).max())
    assert errors[1] < 1.1e-2 * errors[0]


@pytest.mark.parametrize("still", [False, True])
def test_linear_model_predicts_the_difference_of_motions(craft, still):
    """Two motions of the plant that begin a little apart, against the model frozen at their first state over a short
    time: the error falls with the square of what they are apart.
    """
    x = moved(craft, 2, 0.5)
    if still:
        x[len(craft.coordinates) :] = 0.0
    model, rng = craft.linearize(x), np.random.default_rng(3)
    xi = rng.uniform(-1, 1, craft.small.n)
    dx = craft.dynamics(x)
    T = craft.small.forward(x)
    dT = craft.small.forward(x + dx) - T  # T is linear in x
    errors = []
    for h in (1e-4, 1e-5):
        # d/dt (T xi) = f(x + T xi) - f(x) must be T (A xi) + dT xi
        change = craft.dynamics(x + h * T @ xi) - dx
        errors.append(np.abs(craft.small.back(x) @ (change - h * dT @ xi) - h * model.A @ xi).max())
    assert errors[1] < 1.5e-2 * errors[0]


def test_rates_of_turns_are_deviations(craft):
    """dq/dt is a state: rows of ones without rounding; quaternions have no root of their own."""
    x = moved(craft, 4)
    model = craft.linearize(x)
    for a in craft.attitudes:
        rows = model.A[craft.small.turn(a)]
        np.testing.assert_array_equal(rows[:, craft.small.spin(a)], np.eye(3))
        assert np.count_nonzero(rows) == 3
    assert len(model.A) == 2 * len(craft.speeds)


def test_cut(craft):
    x = craft.state(arm=0.3, base_x=2.0, arm_rate=0.4)
    found = dict(zip((s.name for s in craft.deviations), craft.small.cut(x), strict=True))
    assert {name: value for name, value in found.items() if value} == {"arm": 0.3, "base_x": 2.0, "arm_rate": 0.4}

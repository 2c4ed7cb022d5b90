"""The law after the end of a nominal, of a mass that a force pushes: a period of it in closed form."""

import numpy as np
import pytest

from pliant.controllers.linear_quadratic.held_goal import held_by_model
from pliant.plants.linear.ltv import LTVModel

DT = 0.2


@pytest.mark.parametrize(("speed", "force"), [(0.0, 0.0), (1.5, 0.0), (0.0, 2.0)])
def test_a_period_about_the_last_node_of_a_mass(speed, force):
    """x+ = x + dt v + dt^2/2 F, v+ = v + dt F: what a goal that moves, or is pushed, loses in a period."""
    t, e = DT * np.arange(6), np.zeros
    x = np.column_stack([speed * t, np.full(6, speed)])
    A, B = np.tile([[0.0, 1.0], [0.0, 0.0]], (6, 1, 1)), np.tile([[0.0], [1.0]], (6, 1, 1))
    fields = {"c": e((6, 2)), "x": x, "u": e((6, 1)), "y": e((6, 0))}
    empty = e((6, 2, 0)), e((6, 0, 2)), e((6, 0, 1)), e((6, 0, 0))
    model = LTVModel(t, A, B, *empty, **fields, states=("x", "v"), inputs=("F",), disturbances=(), outputs=())
    K, u = np.arange(12.0).reshape(6, 1, 2), np.full((6, 1), force)
    hold = held_by_model(K, x, u, model, (np.eye(2), np.eye(1), np.zeros((2, 1))))
    np.testing.assert_allclose(hold.A, [[1.0, DT], [0.0, 1.0]], rtol=1e-14)
    np.testing.assert_allclose(hold.B, [[DT**2 / 2], [DT]], rtol=1e-14)
    np.testing.assert_array_equal(hold.K, K[-1])
    moved = [DT * speed + DT**2 / 2 * force, DT * force]
    np.testing.assert_allclose(hold.rest, moved, rtol=1e-12, atol=1e-14)

"""The equations as they stand where no speed is free."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes


def test_where_all_speeds_are_driven_nothing_is_lacking():
    """A rigid link spun as it is told: a = u, A = [[0, 1], [0, 0]]."""
    plant = dataclasses.replace(scenes.get("spin-up").plant, kinematics="rigid")
    balance, rng = plant.force_balance, np.random.default_rng(0)
    t, x, u = np.arange(3.0), rng.normal(size=(3, plant.nx)), rng.normal(size=(3, plant.nu))
    M = balance.mass(t, x, u)
    assert M.shape == (3, 0, 0) and balance.lacking(t, x, u, u).shape == (3, 0)
    np.testing.assert_array_equal(balance.accelerations(t, x, u, M), u)
    np.testing.assert_array_equal(balance.state_jacobians(t, x, u, u), np.tile([[0.0, 1.0], [0.0, 0.0]], (3, 1, 1)))


@pytest.mark.parametrize("name", ["two-link-reach", "cantilever-drop", "spacecraft-slew"])
def test_near_jacobians_are_those_of_the_expressions_and_the_mass_is_exact(name):
    plant = scenes.get(name).plant.physics()
    rng, B = np.random.default_rng(1), 5
    x = 0.05 * rng.normal(size=(B, plant.nx)) + plant.rest_state
    t, u = np.zeros(B), rng.normal(size=(B, plant.nu))
    balance = plant.force_balance
    a, M = rng.normal(size=(B, balance.n)), balance.mass(t, x, u)
    solved = plant.dynamics(x, u)[:, -balance.n :]  # M factored symbolically
    found = balance.accelerations(t, x, u, M)
    np.testing.assert_allclose(found, solved, rtol=1e-8, atol=1e-10 * np.abs(solved).max())
    exact, near = balance.state_jacobians(t, x, u, a), balance.near_jacobians(t, x, u, a, M)
    assert (np.abs(near - exact) <= 1e-5 * np.abs(exact).max(axis=2, keepdims=True)).all()

"""The equations as they stand where no speed is free."""

import dataclasses

import numpy as np

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

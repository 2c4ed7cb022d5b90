"""Inputs through elastic gears, as if they were stiff, against the equation of a stiff geared joint."""

import numpy as np
import pytest

from pliant.envs.machines import trees
from pliant.plants.integration.minimum_jerk import minimum_jerk
from pliant.plants.multibody_parts.geared_inputs import GearedInputs


def test_the_motor_has_the_torque_of_a_stiff_joint_over_its_ratio() -> None:
    """u = ((J + n^2 J_m) q'' + n^2 b q') / n with J = 5/12 + 5/4 + 2 + 0.005 kg m^2, n = 100, J_m = 2e-5, b = 1e-4."""
    plant = trees.flexible_joint()
    x0, x1 = np.zeros(4), np.array([1.0, 100.0, 0.0, 0.0])
    u = plant.rest_to_rest(x0, x1, 2.0)
    assert isinstance(u, GearedInputs)
    t = np.array([0.3, 1.0, 1.7, 2.5])
    _, rate, acceleration = minimum_jerk(np.minimum(t / 2.0, 1.0))
    J = 5 / 12 + 5 / 4 + 2.0 + 0.005
    want = ((J + 0.2) * acceleration / 4.0 + 1.0 * rate / 2.0) / 100.0
    np.testing.assert_allclose(u.at_times(t)[:, 0], want, rtol=1e-9, atol=1e-15)
    assert u(0.3)[0] == pytest.approx(want[0], rel=1e-9)


def test_the_states_are_checked() -> None:
    with pytest.raises(ValueError, match=r"rest_to_rest.begin"):
        trees.flexible_joint().rest_to_rest(np.zeros(3), np.zeros(4), 1.0)

"""Euler angles at their singularity, the middle turn at 90 degrees: their rates run away, the quaternion's do not."""

import dataclasses

import numpy as np

from pliant.plants.core.quaternions import quaternion
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="rigid", translation=False)


def euler_rates(angles, omega):
    """d(roll, pitch, yaw)/dt of the 3-2-1 sequence from body rates: divides by cos(pitch)."""
    roll, pitch, _ = angles
    across = np.sin(roll) * omega[1] + np.cos(roll) * omega[2]
    return np.array(
        [omega[0] + across * np.tan(pitch), np.cos(roll) * omega[1] - np.sin(roll) * omega[2], across / np.cos(pitch)]
    )


def test_the_rates_of_euler_angles_run_away_and_the_quaternion_goes_through():
    omega = np.array([0.0, 0.1, 0.02])
    largest = {}
    for pitch in (1.4, 1.5, 1.56, np.pi / 2 - 1e-6):
        largest[pitch] = np.abs(euler_rates([0.0, pitch, 0.0], omega)).max()
        x = CRAFT.state(rate_y=0.1, rate_z=0.02)
        x[CRAFT.layout.quaternion] = quaternion([0.0, pitch, 0.0])
        assert (
            np.abs(CRAFT.dynamics(x)[CRAFT.layout.quaternion]).max() < 0.06
        )  # half the body rate, whatever the attitude
        assert np.linalg.cond(CRAFT.linearize(x).A + np.eye(CRAFT.nx - 1)) < 10
    assert largest[np.pi / 2 - 1e-6] > 1e4  # [rad/s] for a spacecraft that turns at 0.1


def test_a_slew_through_the_singularity():
    """A steady turn about y through 90 degrees: the attitude is known in closed form all along."""
    t = np.linspace(0, 40, 81)
    run = CRAFT.simulate(CRAFT.state(rate_y=0.1), None, t)  # y is a principal axis of the whole: the turn is steady
    exact = np.column_stack([np.cos(0.05 * t), 0 * t, np.sin(0.05 * t), 0 * t])
    np.testing.assert_allclose(run.x[:, CRAFT.layout.quaternion], exact, atol=1e-9)
    assert 0.1 * t[-1] > np.pi / 2

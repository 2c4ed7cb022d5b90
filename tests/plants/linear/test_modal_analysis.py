"""What modal analysis reads off eigenvalues; modes of models are in test_lti.py."""

import numpy as np
import pytest
import scipy.linalg

from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.modal_analysis import modes, rates


def test_rates_of_a_sampled_model_are_those_of_the_continuous_one():
    """s = log(z) / dt, and what dies within one period (z = 0) decays at an infinite rate."""
    exact = np.array([complex(-0.02, -2.0), complex(-0.02, 2.0), -1.0])
    np.testing.assert_array_equal(rates(exact, None), exact)
    for dt in (1e-3, 0.3, 1.5):  # 2 rad/s is below pi / 1.5 s
        np.testing.assert_allclose(rates(np.exp(exact * dt), dt), exact, rtol=0, atol=1e-11)
    assert rates(np.zeros(1, dtype=complex), 0.1).tolist() == [complex(-np.inf, 0.0)]


def chain(n=3):
    """n equal masses in a row on springs, free at both ends: one rigid motion, then 2 sin(k pi / 2 n) rad/s."""
    K = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    K[0, 0] = K[-1, -1] = 1.0
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K, np.zeros((n, n))]])


@pytest.mark.parametrize("dt", [None, 0.1])
def test_rigid_motions_come_first_at_no_frequency_and_hold_no_noise(dt):
    A, names = chain(), [f"q{k}" for k in range(3)] + [f"q{k}_rate" for k in range(3)]
    found = modes(A if dt is None else scipy.linalg.expm(dt * A), names, dt)
    hz = [mode.frequency_hz for mode in found]
    assert hz[:2] == [0.0, 0.0]
    np.testing.assert_allclose(hz[2:], [2 * np.sin(k * np.pi / 6) / (2 * np.pi) for k in (1, 2)], rtol=1e-9)


def test_a_model_reduced_by_its_modes_keeps_its_rigid_motion_first():
    """Two states are those of the whole's mass centre: a third of the force's acceleration."""
    A = chain()
    model = LinearModel.from_matrices(A, np.eye(6)[:, 3:4], np.eye(6)[:3])
    small = model.reduce(2, method="modal")
    assert np.abs(small.eigenvalues).max() < 1e-6
    B, C = small.B, small.C
    np.testing.assert_allclose(C @ small.A @ B, np.full((3, 1), 1 / 3), atol=1e-9)

"""Modes that a design cannot reach, or does not see, are named in its error; those that decay need not be reached."""

import numpy as np
import pytest
from scipy.linalg import block_diag, expm

from pliant.controllers import riccati
from pliant.plants.core.errors import UncontrollableError

DOUBLE = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])


def oscillator(f, zeta=0.0):
    w = 2 * np.pi * f
    return np.array([[0.0, 1.0], [-(w**2), -2 * zeta * w]])


CASES = {
    "free body": (DOUBLE[0], ("theta1", "omega1"), ("mode 0.00 Hz (theta1)",)),
    "undamped": (oscillator(18.9), ("q21", "v21"), ("mode 18.90 Hz (q21)",)),
    "two free bodies": (
        block_diag(DOUBLE[0], DOUBLE[0]),
        ("theta1", "omega1", "theta2", "omega2"),
        ("mode 0.00 Hz (theta1)", "mode 0.00 Hz (theta2)"),
    ),
    "growing": (np.array([[0.3]]), ("heat",), ("mode 0.05 Hz (heat)",)),
}


@pytest.mark.parametrize("dt", [None, 0.01])
@pytest.mark.parametrize("case", CASES)
def test_modes_out_of_reach_are_named(case, dt):
    A, names, expected = CASES[case]
    n = len(A)
    A = block_diag(DOUBLE[0], A)  # one double integrator that is reached
    B = np.vstack([DOUBLE[1], np.zeros((n, 1))])
    mix = np.eye(n + 2) if n == 4 else np.eye(n + 2) + np.diag(np.full(n + 1, 1e-3), -1)
    A, B = mix @ A @ np.linalg.inv(mix), mix @ B
    with pytest.raises(UncontrollableError, match="cannot be reached by the input") as caught:
        if dt is None:
            riccati.lqr(A, B, np.eye(n + 2), np.eye(1), names=("phi", "rate", *names))
        else:
            riccati.dlqr(expm(A * dt), dt * B, np.eye(n + 2), np.eye(1), names=("phi", "rate", *names), dt=dt)
    assert set(caught.value.modes) == set(expected)


@pytest.mark.parametrize("dt", [None, 0.01])
@pytest.mark.parametrize("case", CASES)
def test_modes_that_the_cost_does_not_see_are_named(case, dt):
    A, names, expected = CASES[case]
    n = len(A)
    A, B, Q = block_diag(DOUBLE[0], A), np.eye(n + 2), np.diag([1.0, 0.0] + n * [0.0])
    with pytest.raises(UncontrollableError, match="cannot be seen by the cost") as caught:
        if dt is None:
            riccati.lqr(A, B, Q, np.eye(n + 2), names=("phi", "rate", *names))
        else:
            riccati.dlqr(expm(A * dt), dt * B, Q, np.eye(n + 2), names=("phi", "rate", *names), dt=dt)
    assert set(caught.value.modes) == set(expected)


def test_filter_errors():
    A = block_diag(DOUBLE[0], oscillator(2.0))
    known = {"names": ("theta", "omega", "q", "v")}
    with pytest.raises(UncontrollableError, match=r"mode 2\.00 Hz \(q\) cannot be seen by the output"):
        riccati.kalman(A, np.eye(4), np.eye(4)[:1], np.eye(4), np.eye(1), **known)
    with pytest.raises(UncontrollableError, match=r"mode 2\.00 Hz \(q\) is not driven by the noise"):
        riccati.kalman(A, np.eye(4)[:, 1:2], np.eye(4), np.eye(1), np.eye(4), **known)


def test_modes_that_decay_need_not_be_reached_and_weak_ones_are():
    A = block_diag(DOUBLE[0], oscillator(5.0, 0.01))
    B = np.array([[0.0], [1.0], [0.0], [0.0]])
    assert riccati.lqr(A, B, np.eye(4), np.eye(1)).poles.real.max() < 0
    B[3] = 1e-4
    assert riccati.lqr(block_diag(DOUBLE[0], oscillator(5.0)), B, np.eye(4), np.eye(1)).poles.real.max() < 0


@pytest.mark.parametrize(("design", "a"), [(riccati.kalman, 0.0), (riccati.dkalman, 1.0)])
def test_filters_want_noise_on_what_stays_and_readings_of_it(design, a):
    A, one = np.diag([a, a]), np.eye(2)
    with pytest.raises(UncontrollableError, match=r"x2.* is not driven by the noise w"):
        design(A, [[1.0], [0.0]], one, [[1.0]], one, names=("x1", "x2"))
    with pytest.raises(UncontrollableError, match=r"x1.* cannot be seen by the output"):
        design(A, one, [[0.0, 1.0]], one, [[1.0]], names=("x1", "x2"))

"""What errors reach, against a geometric series and against every sequence of disturbances played."""

import itertools

import numpy as np
import pytest

from pliant.controllers.tube_mpc.disturbance_set import DisturbanceSet
from pliant.controllers.tube_mpc.error_bounds import Course, responses, tightening


def bounds(course, disturbances, times, n, horizon):
    return tightening(course, responses(course, times, n, horizon), disturbances, times)


def still(A, B, C, D, K, Kf=None):
    parts = [np.array(part, dtype=float)[None] for part in (A, B, C, D, K, K if Kf is None else Kf)]
    return Course(*parts)


def test_of_one_state_it_is_the_geometric_series():
    """x+ = 1.2 x + u + w, |w| <= 1, u = -0.7 x: 1 + 1/2 + 1/4 .. of the state, 0.7 times what the state has of it."""
    found = bounds(still([[1.2]], [[1.0]], [[1.0]], [[0.0]], [[0.7]]), DisturbanceSet.box([1.0]), 1, 6, 6)
    series = 2 * (1 - 0.5 ** np.arange(7))
    for end in (found.z_high, found.z_low):
        np.testing.assert_allclose(end[0, :, 0], series, rtol=1e-12)
    for end in (found.u_high, found.u_low):
        np.testing.assert_allclose(end[0, :, 0], 0.7 * series, rtol=1e-12)


def test_past_the_horizon_the_other_law_answers():
    """After two periods with u = -0.7 x come u = -0.2 x: errors of 1, 1/2, 1/4, 1/4, .."""
    course = still([[1.2]], [[1.0]], [[1.0]], [[0.0]], [[0.7]], [[0.2]])
    inputs, signals = (part[0] for part in responses(course, 1, 5, 2))
    np.testing.assert_allclose(signals[:, 0, 0], [1, 0.5, 0.25, 0.25, 0.25])
    np.testing.assert_allclose(inputs[:, 0, 0], [-0.7, -0.35, -0.05, -0.05, -0.05])


def test_readings_that_are_off_count_as_the_plan_sees_them():
    """One period on, x is off by a e, and what is read by e more; two on, that is answered: phi (a e + e) + a e."""
    found = bounds(still([[1.2]], [[1.0]], [[1.0]], [[0.0]], [[0.7]]), DisturbanceSet.box([0.0], [0.1]), 1, 2, 2)
    np.testing.assert_allclose(found.z_high[0, :, 0], [0.0, 0.12, 0.12 + 0.5 * 0.22], rtol=1e-12)
    np.testing.assert_allclose(found.u_high[0, :, 0], [0.0, 0.7 * 0.22, 0.7 * 0.22 * 1.5], rtol=1e-12)


def test_a_signal_with_feedthrough_is_off_in_the_period_of_the_plan():
    course = still([[1.2]], [[1.0]], [[2.0]], [[1.0]], [[0.7]])
    found = bounds(course, DisturbanceSet.box([0.0], [0.1]), 1, 1, 1)
    np.testing.assert_allclose(found.z_high[0, :, 0], [0.2, 0.2 + 1.3 * 0.22], rtol=1e-12)


@pytest.mark.parametrize("feedthrough", [0.0, 0.3])
def test_no_sequence_of_disturbances_goes_further_and_one_goes_as_far(feedthrough):
    """All sequences of corners over four periods of a model that changes; the farthest is the bound, to rounding."""
    rng, n = np.random.default_rng(3), 4
    A, B = 0.8 * rng.standard_normal((n + 2, 2, 2)), rng.standard_normal((n + 2, 2, 1))
    C, K = rng.standard_normal((n + 2, 1, 2)), 0.3 * rng.standard_normal((n + 2, 1, 2))
    D = np.full((n + 2, 1, 1), feedthrough)
    points = rng.standard_normal((n, 3, 2))
    found = bounds(Course(A, B, C, D, K, K), DisturbanceSet(points, np.zeros(2)), n, n, n)
    far, inputs = [], []
    for corners in itertools.product(range(4), repeat=n):
        e = np.zeros(2)
        for k, i in enumerate(corners):
            e = (A[k] - B[k] @ K[k]) @ e + (points[k, i] if i < 3 else 0.0)
        inputs.append((-K[n] @ e)[0])
        far.append((C[n] @ e - D[n] @ K[n] @ e)[0])
    np.testing.assert_allclose([found.z_high[0, n, 0], found.z_low[0, n, 0]], [max(far), -min(far)], rtol=1e-12)
    np.testing.assert_allclose([found.u_high[0, n, 0], found.u_low[0, n, 0]], [max(inputs), -min(inputs)], rtol=1e-12)


def test_the_last_time_stays():
    course = still([[1.2]], [[1.0]], [[1.0]], [[0.0]], [[0.7]])
    found = bounds(course, DisturbanceSet(np.array([[[5.0]], [[1.0]]]), np.zeros(1)), 3, 3, 3)
    np.testing.assert_allclose(found.z_high[:, 3, 0], [0.25 * 5 + 1.5, 1.75, 1.75])

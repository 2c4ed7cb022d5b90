"""A box without a zero of the guardian map, held against loops whose limits are known in closed form."""

import numpy as np
import pytest
import sampled_boxes

from pliant.controllers.robust_analysis.guardian_map import _interpolated, _logarithms, free_of_zeros


def turning(d):
    """r R(1 + d1), in uneven units: stable where r = 0.9 + 0.2 d2 < 1, up to d2 = 1/2."""
    c, s = np.cos(1 + d[0]), np.sin(1 + d[0])
    return (0.9 + 0.2 * d[1]) * np.array([[c, -400 * s], [s / 400, c]])


def test_the_map_is_the_determinant_on_symmetric_matrices():
    """log of prod_{i <= j}: half of what Kronecker's product, and sum, give of all i, j, the diagonal besides."""
    A = np.random.default_rng(0).standard_normal((5, 5))
    A *= 0.9 / np.abs(np.linalg.eigvals(A)).max()
    one, values = np.eye(5), np.linalg.eigvals(A)
    logs, past = _logarithms(A[None], 1.0)
    whole = np.linalg.slogdet(np.eye(25) - np.kron(A, A))[1]
    assert logs[0] == pytest.approx((whole + np.log(np.abs(1 - values**2)).sum()) / 2, rel=1e-10)
    assert past[0] == pytest.approx(-0.1)
    logs, past = _logarithms((A - one)[None], None)
    whole = np.linalg.slogdet(np.kron(A - one, one) + np.kron(one, A - one))[1]
    assert logs[0] == pytest.approx((whole + np.log(np.abs(2 * (values - 1))).sum()) / 2, rel=1e-10)
    assert past[0] == pytest.approx(values.real.max() - 1)


def test_a_stable_box_is_shown_whole_and_with_no_looks_nothing():
    """r < 0.999 where the box ends: few parts do, at any angle."""
    found = free_of_zeros(lambda d: turning(0.495 * d), 2, 0.1, 100)
    assert found.stood == 1.0 and found.unstable is None and 0 < found.parts < 30
    assert free_of_zeros(lambda d: turning(0.495 * d), 2, 0.1, 1).cut_short


def test_what_is_shown_ends_before_what_is_unstable():
    found = free_of_zeros(turning, 2, 0.1, 60)
    assert 0.45 < found.stood <= 0.5 + 1e-9
    assert found.unstable is None or 0.9 + 0.2 * found.unstable[1] > 1.0


def test_a_continuous_loop():
    """x'' + (0.2 + 0.3 d1) x' + (9 + 4 d2) x = 0 is stable to d1 = -2/3."""

    def loop(share):
        return lambda d: np.array([[0.0, 1.0], [-9 - 4 * share * d[1], -0.2 - 0.3 * share * d[0]]])

    assert free_of_zeros(loop(0.66), 2, None, 100).stood == 1.0
    assert free_of_zeros(loop(0.67), 2, None, 60).stood < 0.667 / 0.67


def test_modes_that_are_one_in_the_middle():
    """Two that part by delta^(1/2), 0.9 + 0.1 delta^(1/2) < 1 to delta = 1; the map is smooth there."""
    found = free_of_zeros(lambda d: np.array([[0.9, 1.0], [0.0099 * d[0], 0.9]]), 1, 1.0, 100)
    assert found.stood == 1.0 and found.parts <= 4


def test_a_dip_between_the_first_points_is_not_missed():
    """Stable at every point of a first look: unstable where |d - 0.21| < 0.01, seen by what the interpolation lacks."""

    def dips(d):
        return np.array([[1 - 0.3 * ((d[0] - 0.21) ** 2 - 1e-4)]])

    found = free_of_zeros(dips, 1, 1.0, 200)
    assert found.stood <= 0.2 + 1e-6
    assert found.unstable is None or abs(found.unstable[0] - 0.21) < 0.01


def test_matrices_that_no_polynomial_is_near_are_taken_as_they_are():
    kinked = _interpolated(lambda d: np.array([[0.5 + 0.3 * abs(d[0])]]), 1)
    assert kinked.series is None and kinked.at(np.array([[-1.0]])) == pytest.approx(0.8)
    smooth = _interpolated(lambda d: np.array([[0.5 * np.exp(0.1 * d[0])]]), 1)
    assert smooth.series is not None
    assert smooth.on_grid([np.array([0.3])])[0, 0, 0] == pytest.approx(0.5 * np.exp(0.03), rel=1e-9)


def test_of_many_parameters_it_is_not_tried():
    assert free_of_zeros(lambda d: 0.1 * np.eye(1), 5, 1.0, 100).cut_short


def test_a_sample_of_the_campaign():
    found = sampled_boxes.run(9, 300)  # three parameters
    assert not found["wrong"] and found["gap"] < 0.021

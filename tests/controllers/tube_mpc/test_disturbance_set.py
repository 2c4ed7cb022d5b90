"""How far a set goes in a direction, by its corners and by closed forms; what is no set is refused."""

import numpy as np
import pytest

from pliant.controllers import DisturbanceSet


def test_a_box_goes_as_far_as_the_sum_of_its_sides():
    size, d = np.array([0.1, 0.2, 0.0]), np.array([[1.0, -2.0, 5.0], [0.0, 0.0, 1.0], [-3.0, 0.5, 0.0]])
    np.testing.assert_allclose(DisturbanceSet.box(size).support(0, d), np.abs(d) @ size, rtol=1e-14)


def test_zero_is_always_in_it_and_the_last_period_stays():
    made = DisturbanceSet(np.array([[[1.0, 0.0]], [[0.0, 2.0]]]), np.zeros(2))
    np.testing.assert_array_equal(made.support(0, np.eye(2)), [1.0, 0.0])
    for k in (1, 2, 99):
        np.testing.assert_array_equal(made.support(k, np.eye(2)), [0.0, 2.0])
    np.testing.assert_array_equal(made.support(0, -np.eye(2)), [0.0, 0.0])


def test_a_share_of_it():
    made = DisturbanceSet.box([0.4, 0.2], [1.0, 2.0]).scaled(0.5)
    np.testing.assert_allclose(made.support(0, np.eye(2)), [0.2, 0.1])
    np.testing.assert_array_equal(made.noise, [0.5, 1.0])


@pytest.mark.parametrize(
    ("points", "noise", "words"),
    [
        (np.zeros((1, 0, 2)), np.zeros(2), "must hold a period and a point"),
        (np.zeros((2, 3)), np.zeros(3), r"DisturbanceSet\.points"),
        (np.zeros((1, 1, 2)), [-1.0, 0.0], "must be >= 0"),
        (np.zeros((1, 1, 2)), np.zeros(3), r"DisturbanceSet\.noise"),
    ],
)
def test_no_set(points, noise, words):
    with pytest.raises(ValueError, match=words):
        DisturbanceSet(points, noise)


def test_bad_input():
    with pytest.raises(ValueError, match=r"must have 1 to 12"):
        DisturbanceSet.box(np.ones(13))
    with pytest.raises(ValueError, match=r"DisturbanceSet\.support\.directions has shape \(1, 3\)"):
        DisturbanceSet.box([1.0, 1.0]).support(0, np.ones((1, 3)))

"""The minimum-jerk motion (Flash and Hogan 1985): 10 s^3 - 15 s^4 + 6 s^5."""

import numpy as np
import pytest

from pliant.plants.integration.minimum_jerk import minimum_jerk


def test_it_rests_at_both_ends_and_is_half_way_at_half_time():
    for s, place in ((0.0, 0.0), (1.0, 1.0)):
        assert minimum_jerk(s) == (place, 0.0, 0.0)
    assert minimum_jerk(0.5) == (0.5, 1.875, 0.0)  # peak speed 15/8 of the mean


def test_rates_are_derivatives():
    s, h = np.linspace(0.1, 0.9, 9), 1e-5
    (back, slow, _), (ahead, fast, _) = minimum_jerk(s - h), minimum_jerk(s + h)
    np.testing.assert_allclose(minimum_jerk(s)[1], (ahead - back) / (2 * h), atol=1e-8)
    np.testing.assert_allclose(minimum_jerk(s)[2], (fast - slow) / (2 * h), atol=1e-8)


def test_largest_acceleration():
    """10 / sqrt 3 at s = (3 - sqrt 3) / 6."""
    assert minimum_jerk((3 - np.sqrt(3)) / 6)[2] == pytest.approx(10 / np.sqrt(3), rel=1e-14)


def test_outside_it_stays_at_the_ends():
    assert minimum_jerk(-1.0)[0] == 0.0
    assert minimum_jerk(np.array([-1.0, 2.0]))[0].tolist() == [0.0, 1.0]

"""The minimum-jerk motion (Flash and Hogan 1985): 10 s^3 - 15 s^4 + 6 s^5."""

import numpy as np
import pytest

from pliant.plants.integration.minimum_jerk import bang_bang, jerk_limited, minimum_jerk, profile_of


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


@pytest.mark.parametrize("ramp", [0.0, 0.05, 0.125, 0.25])
def test_a_limited_jerk_is_its_own_integral(ramp) -> None:
    """Rates and accelerations by differences; ends at rest; the largest acceleration as it is stated."""
    s = np.linspace(0.0, 1.0, 4001)
    way, rate, acceleration = jerk_limited(s, ramp)
    assert way[[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-15) and rate[[0, -1]] == pytest.approx([0.0, 0.0])
    inner = slice(2, -2)
    assert np.gradient(way, s)[inner] == pytest.approx(rate[inner], abs=2e-3)
    if ramp:
        assert np.gradient(rate, s)[inner] == pytest.approx(acceleration[inner], abs=2e-3 / ramp)
    assert acceleration.max() == pytest.approx(4 / (1 - 2 * ramp), rel=1e-3)
    assert jerk_limited(0.3, ramp) == pytest.approx(tuple(part[1200] for part in (way, rate, acceleration)))


def test_bang_bang_is_two_parabolas_and_nothing_outside() -> None:
    s = np.array([-0.1, 0.25, 0.75, 1.5])
    way, rate, acceleration = bang_bang(s)
    assert way == pytest.approx([0, 0.125, 0.875, 1.0]) and rate == pytest.approx([0, 1, 1, 0])
    assert acceleration == pytest.approx([0, 4, -4, 0])


def test_profiles_by_name() -> None:
    assert profile_of("slew", "bang-bang") is bang_bang
    with pytest.raises(ValueError, match=r"profile = 'quick' must be one of"):
        profile_of("slew", "quick")
    with pytest.raises(ValueError, match="ramp"):
        jerk_limited(0.5, 0.3)

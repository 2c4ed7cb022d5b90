"""CVODES through CasADi: closed forms, one object for every interval, a motion that ends."""

import numpy as np
import pytest

from pliant.plants import IntegrationError
from pliant.plants.integration import cvodes

P = np.zeros(0)


def test_a_vibration_is_a_cosine_from_any_start_time(vibration):
    """The equations do not depend on t: intervals of one length give one change."""
    for began in (0.0, 7.0):
        after = cvodes.advance(vibration, began, began + 0.5, np.array([1.0, 0.0]), np.zeros(1), np.zeros(1), P, 1e-10,
                               1e-12)  # fmt: skip
        np.testing.assert_allclose(after, [np.cos(1.5), -3 * np.sin(1.5)], atol=1e-7)


def test_input_and_disturbance_add(vibration):
    """x'' = -9 (x - 1): from (0, 0), x = 1 - cos 3t."""
    u, w = np.array([4.0]), np.array([5.0])
    after = cvodes.advance(vibration, 0.0, 1.0, np.zeros(2), u, w, P, 1e-10, 1e-12)
    np.testing.assert_allclose(after, [1 - np.cos(3.0), 3 * np.sin(3.0)], atol=1e-7)


def test_it_stops_where_the_motion_ends(blowing):
    with pytest.raises(IntegrationError, match="cvodes"):
        cvodes.advance(blowing, 0.0, 2.0, np.array([1.0]), np.zeros(1), np.zeros(0), P, 1e-8, 1e-8)


def test_an_input_of_time_is_refused(vibration):
    with pytest.raises(ValueError, match="needs an input held between times"):
        vibration.simulate([1.0, 0.0], lambda t: [0.0], [0.0, 1.0], method="cvodes")


def test_time_itself_is_the_intervals_own(blowing):
    """x' = t is x = t^2 / 2: over [3, 5] it grows by 8."""

    class Timed(type(blowing)):
        def ode(self, t, x, u, w):
            return t + 0 * x

    after = cvodes.advance(Timed(), 3.0, 5.0, np.zeros(1), np.zeros(1), np.zeros(0), P, 1e-10, 1e-12)
    assert after[0] == pytest.approx(8.0, abs=1e-7)

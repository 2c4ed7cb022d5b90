"""Radau IIA: a stiff state in few evaluations, an input of time, a motion that ends."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import IntegrationError
from pliant.plants.integration.radau import march

P, TIGHT = np.zeros(0), {"rtol": 1e-9, "atol": 1e-9, "first": 1e-3}
TIMES = np.linspace(0.0, 4.0, 9)


def test_a_vibration_is_a_cosine(vibration):
    found, evaluations = march(vibration, TIMES, np.array([1.0, 0.0]), np.zeros(1), None, np.zeros(1), P, **TIGHT)
    np.testing.assert_allclose(found[:, 0], np.cos(3.0 * TIMES), atol=1e-6)
    assert evaluations > 0


def test_an_input_of_time(vibration):
    """x'' = -9 x + 8 cos t from (1, 0) is x = cos t."""
    start, law = np.array([1.0, 0.0]), lambda t: np.array([8.0 * np.cos(t)])
    found = march(vibration, TIMES, start, np.zeros(1), law, np.zeros(1), P, **TIGHT)[0]
    np.testing.assert_allclose(found[:, 0], np.cos(TIMES), atol=1e-6)


@pytest.mark.campaign
def test_it_stops_where_the_motion_ends(blowing):
    """1 / (1 - t) is infinite at 1 s."""
    with np.errstate(all="ignore"), pytest.raises(IntegrationError, match="radau stopped after t = "):
        march(blowing, np.array([0.0, 2.0]), np.array([1.0]), np.zeros(1), None, np.zeros(0), P, **TIGHT)


def test_a_fast_mode_held_still_costs_nothing(vibration):
    """omega = 1e5 rad/s at rest: an explicit method would need 1e5 steps and more."""
    stiff = dataclasses.replace(vibration, omega=1e5)
    found, evaluations = march(stiff, TIMES, np.zeros(2), np.ones(1) * 1e10, None, np.array([-1e10]), P, **TIGHT)
    assert np.abs(found).max() < 1e-6 and evaluations < 1000

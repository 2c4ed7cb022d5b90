"""Modes followed by their shapes through crossings and veering."""

import numpy as np
import pytest

from pliant.plants.periodic.mode_tracking import mac, modes, track


def oscillators(K):
    n = len(K)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K, -0.02 * np.eye(n)]])


def test_modes_are_the_oscillations():
    found = modes(oscillators(np.diag([9.0, 4.0])))
    assert found.values.imag == pytest.approx([2, 3], rel=1e-4) and found.shapes.shape == (4, 2)
    assert mac(found.shapes, found.shapes) == pytest.approx(np.eye(2), abs=1e-2)
    assert not len(modes(np.diag([-1.0, -2.0])).values)


def test_curves_cross_where_nothing_couples_them():
    places, found, worst = track(lambda s: oscillators(np.diag([4.0 + s, 9.0])), np.linspace(0, 10, 6), 0.8, 8)
    assert found[-1].values.imag == pytest.approx([np.sqrt(14), 3], rel=1e-4)
    assert places == pytest.approx(np.linspace(0, 10, 6)) and worst > 0.9


def test_curves_veer_where_something_does():
    """A weak coupling: each curve keeps its order while its shape turns into the other's."""
    at = lambda s: oscillators(np.array([[4.0 + s, 0.4], [0.4, 9.0]]))  # noqa: E731
    places, found, worst = track(at, np.linspace(0, 10, 5), 0.8, 10)
    assert len(places) > 5 and worst > 0.8
    assert found[-1].values.imag[0] < found[-1].values.imag[1]


def test_a_mode_that_ends_is_nan():
    _, found, _ = track(lambda s: oscillators(np.diag([4.0 - s, 9.0])), np.array([0.0, 2.0, 8.0]), 0.5, 4)
    assert np.isnan(found[-1].values[0]) and found[-1].values[1].imag == pytest.approx(3, rel=1e-4)

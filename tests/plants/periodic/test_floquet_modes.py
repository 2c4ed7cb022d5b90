"""Floquet modes in outputs, held against a constant model seen from a frame that turns."""

import numpy as np
import pytest

from pliant.plants import LTVModel
from pliant.plants.periodic.floquet_modes import output_mode
from pliant.plants.stability import floquet

T = 2 * np.pi / 5.0


@pytest.fixture(scope="module")
def model():
    """An oscillator of 1.3 rad/s and its output cos(5 t) x1: seen at 5 +- 1.3 rad/s alone."""
    t = np.linspace(0, T, 65)
    A = np.tile(np.array([[-0.1, 1.3], [-1.3, -0.1]]), (65, 1, 1))
    C = np.zeros((65, 2, 2))
    C[:, 0, 0], C[:, 1, 1] = np.cos(5 * t), 1.0
    none = np.zeros((65, 2, 0))
    rows = {"c": np.zeros((65, 2)), "x": np.zeros((65, 2)), "u": np.zeros((65, 0)), "y": np.zeros((65, 2))}
    signals = {"states": ("a", "b"), "inputs": (), "disturbances": (), "outputs": ("turned", "still")}
    return LTVModel(t, A, none, none, C, none, none, **rows, **signals)


def test_where_it_is_seen(model):
    found = output_mode(model, floquet(model, T), 0)
    turned, still = found.shares.T
    assert found.frequencies[still > 1e-3] == pytest.approx([1.3], abs=1e-6)
    assert np.sort(found.frequencies[turned > 1e-3]) == pytest.approx([3.7, 6.3], abs=1e-6)
    assert found.exponent.real == pytest.approx(-0.1, abs=1e-9) and found.strongest == pytest.approx(1.3, abs=1e-6)
    assert np.abs(found["still"]) == pytest.approx(1.0, abs=1e-6)
    assert np.abs(found.y[0] - found.y[-1]).max() < 1e-6


def test_bad_input(model):
    cycle = floquet(model, T)
    for given, words in (((None, cycle, 0), "model"), ((model, None, 0), "cycle"), ((model, cycle, 2), "k")):
        with pytest.raises(ValueError, match=words):
            output_mode(*given)

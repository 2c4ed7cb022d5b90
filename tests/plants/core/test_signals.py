"""Signals by name, rows of [x; y], and how inputs of every form are sampled."""

import numpy as np
import pytest

from pliant.plants import LinearModel
from pliant.plants.core.signals import GAUSS, Signal, as_signals, index, rows_by_name, sample

MODEL = LinearModel.from_matrices(
    [[0.0, 1.0], [-4.0, -0.4]],
    [[0.0], [2.0]],
    [[1.0, 0.0], [-4.0, -0.4]],
    [[0.0], [2.0]],
    states=("place", "speed"),
    outputs=("place", "acceleration"),
    E=[[0.0], [1.0]],
    F=[[0.0], [1.0]],
)


def test_rows_are_those_of_the_stack_and_a_state_goes_before_an_output():
    """The acceleration of a cart on a spring, -4 x - 0.4 v + 2 u + w, and its states."""
    rows = rows_by_name(MODEL, ["acceleration", "place"])
    assert rows.at == [3, 0]
    assert rows.C.tolist() == [[-4.0, -0.4], [1.0, 0.0]]
    assert rows.D.tolist() == [[2.0], [0.0]]
    assert rows.F.tolist() == [[1.0], [0.0]]


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(ValueError, match="sensor 'height' must be one of place, speed, place, acceleration"):
        rows_by_name(MODEL, ["height"], "sensor")
    with pytest.raises(ValueError, match=r"input 'u' must be one of \(there are none\)"):
        index((), "u", "input")


def test_names_are_counted_and_distinct():
    assert as_signals("A", None, 2, "x") == (Signal("x1", ""), Signal("x2", ""))
    with pytest.raises(ValueError, match="must be 2 names"):
        as_signals("A", ["one"], 2, "x")
    with pytest.raises(ValueError, match="must be distinct names"):
        as_signals("A", ["one", "one"], 2, "x")


def test_two_gauss_points_integrate_a_cubic_exactly():
    """The integral of t^3 over [1, 3] is 20 (Gauss-Legendre with n points: degree 2 n - 1)."""
    t = np.array([1.0, 3.0])
    _, inner = sample("u", lambda s: [s**3], t, 1)
    assert inner.mean() * 2.0 == pytest.approx(20.0, rel=1e-14)
    np.testing.assert_allclose(GAUSS, [0.5 - 1 / np.sqrt(12), 0.5 + 1 / np.sqrt(12)], rtol=1e-15)


def test_a_held_array_stays_over_its_interval():
    nodes, inner = sample("u", [[1.0], [5.0], [9.0]], np.array([0.0, 1.0, 2.0]), 1)
    assert nodes.ravel().tolist() == [1.0, 5.0, 9.0]
    assert inner[..., 0].tolist() == [[1.0, 1.0], [5.0, 5.0]]

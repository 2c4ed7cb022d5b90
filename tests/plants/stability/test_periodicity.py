"""Whether A(t) repeats, and what is seen to vary beside fast modes."""

import json

import numpy as np
import pytest

from pliant.plants.stability import assess, floquet
from pliant.plants.stability.periodicity import find, varying, why_not


def test_a_slow_period_of_a_fast_model(model_of):
    """An orbit's period and modes of some rad/s: 8,000 turns. Exponents and growth in closed form."""
    omega, period = np.array([0.01, 0.2, 5.0]), 2000.0
    t = np.linspace(0.0, period, 401)
    A = np.zeros((401, 6, 6))
    A[:, :3, 3:], A[:, 3:, :3] = np.eye(3), -np.diag(omega**2)
    damping = 0.005 * (1 + 0.5 * np.cos(2 * np.pi * t / period))
    A[:, 3:, 3:] = -damping[:, None, None] * 2 * np.diag(omega)
    found = assess(model_of(t, A), period=period)
    assert (found.verdict, found.method) == ("stable", "floquet")
    assert found.margin == pytest.approx(0.005 * 0.01, rel=1e-3)  # the mean of its damping
    assert found.evidence["floquet"].steps > 4096 > len(found.evidence["growth"].windows)
    shape = found.evidence["floquet"].mode(0)
    np.testing.assert_allclose(shape[-1], shape[0], atol=1e-6 * np.abs(shape).max())


def test_slow_coefficients_beside_fast_modes_are_seen_to_vary(model_of):
    """A mode at 1e4 rad/s does not hide that the slow one, at 1e-3 rad/s, is pumped: Mathieu's first tongue."""
    t = np.linspace(0.0, np.pi / 1e-3, 129)
    A = np.zeros((129, 4, 4))
    A[:, :2, 2:], A[:, 3, 1], A[:, 3, 3] = np.eye(2), -1e8, -100.0
    A[:, 2, 0] = -1e-6 * (1 + 0.4 * np.cos(2e-3 * t))
    moving, _ = varying(model_of(t, A))
    assert moving.shape == (129, 1)
    with pytest.raises(
        ValueError, match=r"floquet: a period of 3141\.59 s and modes of up to 1e\+04 1/s need 16,777,216"
    ):
        floquet(model_of(t, A), np.pi / 1e-3)
    whole = assess(model_of(t, A))
    assert whole.verdict == "undecided" and "leave out the fastest modes" in whole.reasons["growth"]
    assert json.loads(json.dumps(whole.to_json(), allow_nan=False))["margin"] is None
    slow = model_of(t, A[:, ::2, ::2])
    assert assess(slow).verdict == "unstable"
    assert not why_not(model_of(t, A), np.pi / 1e-3) and why_not(model_of(t, A), 2.0 / 1e-3)


@pytest.mark.parametrize("unit", [1.0, 1e6, 1e-6])
def test_a_given_period_is_compared_in_any_unit_of_time(model_of, unit):
    """A(t) of period 1 and of 0.9, each given as 1: in seconds, megaseconds and microseconds."""
    t = np.linspace(0.0, 4.0, 401)
    for period in (1.0, 0.9):
        swing = 1.0 + 0.5 * np.cos(2 * np.pi * t / period)
        A = np.zeros((len(t), 2, 2))
        A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -swing, -0.1
        assert bool(why_not(model_of(t * unit, A / unit), 1.0 * unit)) == (period != 1.0)


@pytest.mark.parametrize("nodes", [101, 202, 401])
def test_two_whole_periods_are_told_from_one_of_twice_the_length(model_of, nodes):
    """The shift of half the span is found whether the middle of the window is a node or not."""
    t = np.linspace(0.0, 4 * np.pi, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -1 - 0.3 * np.cos(t) - 0.1 * np.sin(2 * t), -0.1
    found, why, _ = find(model_of(t, A))
    assert found == pytest.approx(2 * np.pi, rel=1e-6) and "repeats every 6.28" in why

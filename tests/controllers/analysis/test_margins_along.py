"""Margins frozen and along a motion."""

import numpy as np
import pytest
from scipy.optimize import brentq

from pliant.controllers.analysis.loops import loop
from pliant.controllers.analysis.margins import margins
from pliant.controllers.analysis.margins_along import margins_along
from pliant.plants import LTVModel, Signal

T, PULL, PUSH = 2.0, 1.0, 3.0  # dx/dt = x - 3 f x + d, y = x


def scalar(nodes=201):
    t, one, none = np.linspace(0.0, T, nodes), np.ones((nodes, 1, 1)), np.zeros((nodes, 1))
    signals = (Signal("x", "m"),), (Signal("u", "N"),), (Signal("d", "N"),), (Signal("y", "m"),)
    return LTVModel(t, PULL * one, one, one, one, 0 * one, 0 * one, none, none, none, none, *signals)


def pushed(f):
    """The largest |y| by disturbances of unit energy: the root of (e^(2 a T) - 1)/(2 a), a = 1 - 3 f real part."""
    a = PULL - PUSH * f
    return np.sqrt(np.expm1(2 * a * T) / (2 * a))


@pytest.fixture(scope="module")
def found():
    return margins_along(scalar(), np.full((201, 1, 1), PUSH), limit=2.0, frozen=3)


def test_gain_and_phase_along_have_closed_forms(found):
    least = brentq(lambda f: pushed(f) - 2 * pushed(1.0), 0.01, 0.9)
    assert found.gain[0] == pytest.approx(least, rel=2e-3) and found.gain[0] >= least
    assert found.gain[1] == np.inf  # a stiffer loop is pushed less
    assert found.phase_deg == pytest.approx(np.rad2deg(np.arccos(least)), rel=2e-3)


def test_a_delay_along_is_what_a_late_loop_does(found):
    """dx/dt = x(t) - 3 x(t - tau) + d by steps of tau/n: the response to an impulse, its energy the largest gain."""

    def gain(tau, n=200):
        h = tau / n
        x = np.zeros(int(T / h) + 2)
        x[0] = 1.0
        for k in range(len(x) - 1):
            late = [x[k + i - n] if k + i >= n else 0.0 for i in (0, 1)]
            rate = PULL * x[k] - PUSH * late[0]
            x[k + 1] = x[k] + h / 2 * (rate + PULL * (x[k] + h * rate) - PUSH * late[1])
        y = x[: round(T / h) + 1] ** 2
        return np.sqrt(h * (y.sum() - (y[0] + y[-1]) / 2))

    assert gain(found.delay) == pytest.approx(2 * pushed(1.0), rel=0.02)


def test_frozen_margins_are_those_of_the_constant_loop(found):
    constant = margins(loop(scalar().at(0), np.array([[PUSH]]), reads=("x",)))
    assert found.frozen_disk == pytest.approx(np.full(3, constant.disk))
    assert found.frozen_gain[0, 0] == pytest.approx(PULL / PUSH) and found.frozen_gain[0, 0] > 0
    assert found.frozen_delay == pytest.approx(np.full(3, constant.channels[0].delay))
    assert "Frozen" in found.words and "Along" in found.words


def test_a_frozen_loop_that_is_not_stable_has_none():
    found = margins_along(scalar(), np.full((201, 1, 1), 0.5), frozen=2)
    assert found.frozen_disk.tolist() == [0.0, 0.0] and found.gain[0] < 1  # its motion ends all the same
    assert "not stable" in found.words


def test_what_is_no_limit_nor_name():
    for wrong, named in (({"limit": 1.0}, "limit"), ({"outputs": ["no"]}, "no"), ({"disturbances": ["no"]}, "no")):
        with pytest.raises(ValueError, match=named):
            margins_along(scalar(), np.full((201, 1, 1), PUSH), **wrong)

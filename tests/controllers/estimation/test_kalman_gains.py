"""The steady filter of a sampled model, where noise that is held also reaches the reading: scalars in closed form."""

import numpy as np
import pytest

from pliant.controllers.estimation.kalman_gains import Sampled, after, corrected, delayed, resting, steady
from pliant.plants import UncontrollableError

ONE = np.ones((1, 1))


def step(a=1.0, h=0.0, w=2.0, v=3.0, c=1.0):
    return Sampled(a * ONE, ONE, ONE, c * ONE, 0 * ONE, h * ONE, w * ONE, v * ONE, np.zeros(1))


def test_random_walk():
    """x+ = x + w, y = x + v: before a sample P- = (w + sqrt(w^2 + 4 w v))/2, after it P = P- - w, L = P-/(P- + v)."""
    before = (2 + np.sqrt(4 + 24)) / 2
    found = steady(step(), ("x",), 1.0)
    assert found.P[0, 0] == pytest.approx(before - 2, rel=1e-9)
    assert found.L[0, 0] == pytest.approx(before / (before + 3), rel=1e-9)
    assert found.S[0, 0] == pytest.approx(before + 3, rel=1e-9)


@pytest.mark.parametrize("h", [0.0, 0.7, -0.4])
def test_many_samples_come_to_the_steady_one(h):
    one = step(a=0.9, h=h)
    found = corrected(one, 5 * ONE)
    for _ in range(300):
        found = after(one, found.root)
    limit = steady(one, ("x",), 1.0)
    for part, wanted in zip(found, limit):
        np.testing.assert_allclose(part, wanted, rtol=1e-9)


def test_readings_under_way_are_states():
    one = delayed(step(a=0.5, c=2.0), 2)
    x, wanted = resting(2.0 * ONE, 2) @ np.array([3.0]), []
    assert x.tolist() == [3.0, 6.0, 6.0, 6.0]
    for _ in range(4):
        x = one.A @ x
        wanted.append(float((one.C @ x)[0]))
    assert wanted == [6.0, 6.0, 3.0, 1.5]  # y = 2 x two samples ago: 6, 6, then 2 * 1.5, 2 * 0.75


def test_what_stays_must_be_seen_and_driven():
    with pytest.raises(UncontrollableError, match="cannot be seen by the sensors"):
        steady(step(c=0.0), ("x",), 1.0)
    with pytest.raises(UncontrollableError, match="is not driven by the noise W"):
        steady(step(w=0.0), ("x",), 1.0)

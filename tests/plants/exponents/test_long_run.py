"""The verdict from intervals, by hand."""

import numpy as np
import pytest

from pliant.plants.exponents.long_run import from_intervals
from pliant.plants.exponents.transient import Transient


def made(intervals, factor=1.0, regular=True):
    intervals = np.array(intervals, dtype=float)
    n = len(intervals)
    about = tuple((k,) for k in range(n)), -np.diff(intervals[:, 0]), np.eye(n), intervals, regular
    before = Transient(factor, 2.0, np.zeros(n))
    return from_intervals(tuple("abc"[:n]), intervals.mean(axis=1), intervals, *about, before, "so it goes on", np.nan)


@pytest.mark.parametrize(
    ("intervals", "verdict"),
    [
        ([[-0.2, -0.1], [-1, -1]], "stable"),
        ([[-0.2, 0.1], [-1, -1]], "drift"),
        ([[0.0, 0.0], [-1, -1]], "drift"),
        ([[0.2, 0.3], [-0.1, 0.1]], "unstable"),
        ([[-0.2, 0.0], [-1, -1]], "drift"),
    ],
)
def test_verdicts(intervals, verdict):
    found = made(intervals)
    assert found.verdict == verdict
    assert found.why.endswith("provided that so it goes on") and str(found).startswith(verdict)


def test_what_drifts_is_named():
    found = made([[0.2, 0.3], [-0.1, 0.1], [-1, -1]])
    assert [d.states for d in found.drift] == [("b",)] and found.drift[0].low == -0.1


def test_growth_before_and_averages_without_rest_are_said():
    assert "grow up to 1e+06-fold, at 2 s" in made([[-1, -1]], 1e6).why
    assert "not regular" in made([[-1, -1]], regular=False).why

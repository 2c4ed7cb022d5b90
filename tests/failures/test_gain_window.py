"""An unstable plant with a lag that the design does not know holds in a window of gains only.

x' = x + u under u = -3 x; the plant's drive has two lags of T = 0.4 s: (s - 1)(1 + T s)^2 + k, Routh: 1 < k < 1.8 for
all three poles to the left. To lower the gain until it holds, and further for safety, leaves it at its other end.
"""

import numpy as np
import pytest

from pliant.controllers import Feedback, spillover
from pliant.controllers.analysis.spillover import RESERVE
from pliant.plants import LinearModel

T, GAIN = 0.4, 3.0
DESIGN = LinearModel.from_matrices([[1.0]], [[1.0]], states=["a"])
FINE = LinearModel.from_matrices(
    [[1.0, 1, 0], [0, -1 / T, 1 / T], [0, 0, -1 / T]], [[0], [0], [1 / T]], states=["a", "b", "c"]
)


def holds(k):
    """Roots of T^2 s^3 + (2 T - T^2) s^2 + (1 - 2 T) s + k - 1."""
    return np.roots([T**2, 2 * T - T**2, 1 - 2 * T, k - 1]).real.max() < 0


def window():
    """From Routh: k > 1 and (2 T - T^2)(1 - 2 T) > T^2 (k - 1)."""
    return 1.0, 1.0 + (2 * T - T**2) * (1 - 2 * T) / T**2


def test_the_naive_ways_fail():
    low, high = window()
    assert high == pytest.approx(1.8) and not holds(GAIN)
    assert not holds(GAIN / 4)  # "four times slower is safe"
    assert holds(0.99 * high) and not holds(1.01 * high) and not holds(0.99 * low)


def test_pliant_finds_the_window_and_keeps_its_reserve():
    low, high = window()
    found = spillover(Feedback([[GAIN]], ("a",)), [DESIGN, FINE])
    assert not found.holds and found.factor is not None
    k = GAIN * found.factor
    assert low < k and RESERVE * k <= high * (1 + 1e-9)
    assert all(holds(k * f) for f in np.geomspace(1, RESERVE, 200))
    assert k * RESERVE > 0.95 * high  # the first that holds: no slower than need be
    assert "it holds with gain times" in found.verdict and "no factor" not in found.verdict


def test_where_no_window_is_wide_enough_it_says_what_was_tried():
    found = spillover(Feedback([[GAIN]], ("a",)), [DESIGN, FINE], reserve=2.0)
    assert found.factor is None and "factors on the gain in each octave" in found.verdict


def test_the_recommended_gain_holds_in_a_motion():
    found = spillover(Feedback([[GAIN]], ("a",)), [DESIGN, FINE])
    A = FINE.A - GAIN * found.factor * FINE.B @ np.array([[1.0, 0, 0]])
    values, V = np.linalg.eig(A)
    after = (V * np.exp(values * 60.0)) @ np.linalg.solve(V, np.ones(3))
    assert np.abs(after).max() < 0.1

"""The filters' transfers at the frequencies that define them, from their closed forms."""

import numpy as np
import pytest

from pliant.controllers import lag, notch, roll_off


def test_a_notch_is_one_far_away_and_its_depth_at_its_frequency() -> None:
    f = notch(3.0, depth=0.05, width=0.4)
    assert np.abs(f.at([3.0])) == pytest.approx([0.05], rel=1e-12)
    assert np.abs(f.at([0.0, 1e6])) == pytest.approx([1.0, 1.0], rel=1e-9)
    w = np.array([1.0, 2.0, 4.0])
    wanted = (9 - w**2 + 0.05 * 0.4 * 3j * w) / (9 - w**2 + 0.4 * 3j * w)
    assert f.at(w) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("order", [1, 2, 5])
def test_butterworth(order) -> None:
    w = np.array([0.0, 1.0, 2.0, 20.0])
    assert np.abs(roll_off(2.0, order=order).at(w)) ** 2 == pytest.approx(1 / (1 + (w / 2) ** (2 * order)), rel=1e-10)
    assert roll_off(2.0, order=order).poles.real.max() < 0


def test_a_lag() -> None:
    assert lag(0.1, 1.0).at([0.0, 1e9]) == pytest.approx([1.0, 0.1], rel=1e-8)


@pytest.mark.parametrize(
    ("made", "word"),
    [
        (lambda: notch(-1.0), "notch.frequency"),
        (lambda: notch(1.0, depth=1.0), "notch.depth"),
        (lambda: roll_off(1.0, order=0), "order"),
        (lambda: lag(0.0, 1.0), "lag.slow"),
    ],
)
def test_what_is_no_filter_is_told(made, word) -> None:
    with pytest.raises(ValueError, match=word):
        made()

"""A box of parameters in parts."""

import numpy as np
import pytest
import sampled_boxes

from pliant.controllers.robust_analysis.parts_of_box import shown


def turning(d):
    """r R(1 + d1), in uneven units: stable where r = 0.9 + 0.2 d2 < 1, up to d2 = 1/2."""
    c, s = np.cos(1 + d[0]), np.sin(1 + d[0])
    return (0.9 + 0.2 * d[1]) * np.array([[c, -400 * s], [s / 400, c]])


def test_what_is_shown_ends_before_what_is_unstable():
    found = shown(turning, 2, 0.1, 400)
    assert 0.45 < found.stood < 0.5
    assert found.unstable is not None and 0.9 + 0.2 * found.unstable[1] >= 1.0


def test_a_stable_box_is_shown_whole_and_with_no_looks_nothing():
    found = shown(lambda d: turning(0.45 * d), 2, 0.1, 400)
    assert found.stood == 1.0 and found.unstable is None and 1 < found.parts < 100
    assert shown(lambda d: turning(0.45 * d), 2, 0.1, 1).stood == 0.0


def test_a_continuous_loop():
    """x'' + (0.2 + 0.3 d1) x' + (9 + 4 d2) x = 0 is stable to d1 = -2/3."""
    found = shown(lambda d: np.array([[0.0, 1.0], [-9 - 4 * d[1], -0.2 - 0.3 * d[0]]]), 2, None, 1000)
    assert 0.6 < found.stood < 2 / 3


def test_modes_that_are_one_in_the_middle():
    """Two that part by delta^(1/2): eigenvectors alone say nothing in the middle."""
    found = shown(lambda d: np.array([[0.9, 1.0], [0.01 * d[0], 0.9]]), 1, 1.0, 400)
    assert 0.9 < found.stood <= 1.0  # 0.9 + 0.1 delta^(1/2) < 1 to delta = 1


@pytest.mark.parametrize("seed", [0, 7])
def test_a_sample_of_the_campaign(seed):
    found = sampled_boxes.run(seed, 300)
    assert not found["wrong"] and found["gap"] < 0.021

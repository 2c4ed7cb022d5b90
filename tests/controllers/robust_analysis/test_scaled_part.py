"""One part of a box, by scalings."""

import numpy as np
import pytest

from pliant.controllers.robust_analysis.parts_of_box import shown
from pliant.controllers.robust_analysis.scaled_part import holds_by_scalings


def turning(d):
    """r R(1 + d1 / 5), in uneven units: stable where r = 0.9 + 0.2 d2 < 1, up to d2 = 1/2."""
    c, s = np.cos(1 + d[0] / 5), np.sin(1 + d[0] / 5)
    return (0.9 + 0.2 * d[1]) * np.array([[c, -400 * s], [s / 400, c]])


@pytest.mark.parametrize("wide, told", [(0.3, True), (0.5001, False), (0.6, False)])
def test_the_edge_is_kept(wide, told):
    found = holds_by_scalings(turning, np.zeros(2), np.array([1.0, wide]))
    assert found.holds is told and found.left < 0.01  # cos and sin beside their parabolas: (1/5)^3 / 6 and less


def test_real_parameters_count_as_real():
    """(1 +- j d) 0.8 e^(+-j): with a real d of 0.74 within the circle, with a complex one of 1/4 on it."""
    R = 0.8 * np.array([[np.cos(1), -np.sin(1)], [np.sin(1), np.cos(1)]])
    J = np.array([[0.0, -1.0], [1.0, 0.0]])
    assert 0.8 * np.hypot(1, 0.74) < 1 < 0.8 * np.hypot(1, 0.76) and 0.8 * (1 + 0.25) == 1
    for wide, told in ((0.7, True), (0.76, False)):
        assert holds_by_scalings(lambda d: R @ (np.eye(2) + d[0] * J), np.zeros(1), np.array([wide])).holds is told


def test_what_the_form_lacks_counts():
    """0.99 cos(3 d) is no parabola: what is missed is more than what is left to the circle."""
    lost = holds_by_scalings(lambda d: np.array([[0.99 * np.cos(3 * d[0])]]), np.zeros(1), np.ones(1))
    assert not lost.holds and lost.cost == 0
    assert holds_by_scalings(lambda d: np.array([[0.5 * np.cos(0.5 * d[0])]]), np.zeros(1), np.ones(1)).holds


def test_three_parameters_in_few_parts():
    """A pair whose turn, size and shape vary: norms need many parts, scalings few."""

    def loop(d):
        c, s = np.cos(1 + 0.1 * d[0]), np.sin(1 + 0.1 * d[0])
        shape = 1 + 0.1 * d[2]
        return (0.9 + 0.095 * d[1]) * np.array([[c, -shape * s], [s / shape, c]])

    by_norms, both = shown(loop, 3, 1.0, 20), shown(loop, 3, 1.0, 20, 5)
    assert by_norms.cut_short and by_norms.stood < 1
    assert both.stood == 1.0 and not both.cut_short

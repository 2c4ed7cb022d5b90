"""Interpolation around the turn."""

import numpy as np
import pytest

from pliant.controllers.cycles.by_angle import ByAngle


def test_a_function_of_the_angle_is_linear_between_nodes_and_closes():
    angle = 0.3 + 2 * np.pi * 3 * np.arange(40) / 40 * (1 - 1e-9)  # three turns, by time
    nodes = ByAngle(angle)
    values = nodes.around(np.cos(angle)[nodes.order])
    for phi in (0.0, 0.29, 3.0, 6.28, -1.0, 40.0):
        k, share = nodes.at(phi)
        assert 0 <= share <= 1
        assert (1 - share) * values[k] + share * values[k + 1] == pytest.approx(np.cos(phi), abs=0.004)


def test_the_nearest_node_is_one_by_time():
    angle = 2 * np.pi * 3 * np.arange(40) / 40
    nodes = ByAngle(angle)
    for phi in np.linspace(-7, 13, 31):
        off = np.abs((angle - phi + np.pi) % (2 * np.pi) - np.pi)
        assert off[nodes.nearest(phi)] == pytest.approx(off.min(), abs=1e-12)

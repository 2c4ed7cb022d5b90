"""Motions found window by window of their time, where passes over the whole do not settle."""

import numpy as np
import pytest

from pliant.studies.physics.motion_nodes import MotionNodes
from pliant.studies.physics.quasi_linear import NotSettled
from pliant.studies.physics.time_windows import window_by_window

WITHIN = 1e-6  # [m], as in conftest.py


def test_the_whole_does_not_settle_and_windows_do(falling):
    _, _, whole, found = falling
    with pytest.raises(NotSettled):
        whole.settle(WITHIN)
    windows = found.outputs.copy()
    found.settle(WITHIN)
    assert np.abs(found.outputs - windows).max() < 100 * WITHIN
    assert np.abs(found.x[:, 2]).max() > 0.1  # it bends by a tenth and more


def test_what_falls_without_friction_keeps_its_energy(falling):
    """Of nodes 7.5 ms apart, the fastest modes between them: to a hundredth of what it falls by."""
    motions, nodes, _, found = falling
    fine, x = found.fine, found.at_ends[nodes.control]
    total = np.array([fine.energy(row) for row in x])
    fallen = 9.81 * 0.5 * np.ptp([fine.measure(row)[1] for row in x])  # [J] of the payload alone
    assert np.ptp(total) < 1e-2 * fallen
    np.testing.assert_allclose(found.at_ends[0], motions.start(fine), atol=1e-12)


def test_a_period_that_does_not_settle_is_told(falling):
    motions, nodes, _, found = falling
    long = MotionNodes(nodes.times[::50], nodes.held[::50], 1)  # periods of 0.75 s
    rigid = motions.ladder[0]
    with pytest.raises(NotSettled, match=r"settle|runs away|still changes"):
        window_by_window(found.fine, rigid, long, motions.start(found.fine), found.columns, WITHIN)

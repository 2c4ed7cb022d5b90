"""Where a motion is corrected."""

import numpy as np
import pytest

from pliant.studies.physics.motion_nodes import MotionNodes

TIMES = np.array([0.0, 0.1, 0.3, 0.4])


@pytest.mark.parametrize("parts", [1, 3])
def test_two_gauss_points_a_part_integrate_cubics_exactly(parts):
    nodes = MotionNodes(TIMES, np.zeros((4, 1)), parts)
    assert len(nodes.h) == 3 * parts and nodes.h.sum() == pytest.approx(0.4)
    t = nodes.all[nodes.gauss]
    assert np.repeat(nodes.h, 2) / 2 @ t**3 == pytest.approx(0.4**4 / 4, rel=1e-12)
    np.testing.assert_allclose(nodes.all[nodes.ends][nodes.control], TIMES, atol=1e-15)
    assert (np.diff(nodes.all) > 0).all()


def test_inputs_jump_at_control_times_alone():
    held = np.array([[1.0], [2.0], [3.0], [4.0]])
    nodes = MotionNodes(TIMES, held, 2)
    period = np.clip(np.searchsorted(TIMES, nodes.all[:-1] + 1e-9, side="right") - 1, 0, 2)
    np.testing.assert_array_equal(nodes.inputs[:-1, 0], held[period, 0])
    assert nodes.inputs[-1, 0] == 4.0

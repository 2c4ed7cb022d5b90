"""More nodes, more shapes, and windows of time where the whole does not settle."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.node_search import Search

TOLERANCE = 0.2  # [m]


@pytest.fixture(scope="module")
def searched(falling):
    search = Search(falling[0], TOLERANCE)
    return search, *search.corrected()


def test_what_does_not_settle_as_a_whole_is_found_window_by_window(falling, searched):
    """As near as it says to the motion of fewer shapes at other nodes, and to what those leave."""
    search, known, motion = searched
    assert search.windows and motion.nodes.parts > 1 and known.uncertainty < TOLERANCE / 3
    assert np.abs(known.outputs - falling[-1].outputs).max() < TOLERANCE / 3 + known.uncertainty


@pytest.mark.campaign
def test_it_is_as_near_to_the_simulated_motion_as_it_says(falling, searched):
    """dop853's, another method, on the model itself."""
    _, known, _ = searched
    assert np.abs(known.outputs - falling[0].outputs(known.physics, 1e-7)).max() <= known.uncertainty


def test_what_settles_as_a_whole_takes_no_windows():
    motions = Motions(scenes.get("single-link-slew", duration=0.3, move_time=0.2))
    search = Search(motions, 1e-3)
    known, motion = search.corrected()
    assert not search.windows and motion.outputs is known.outputs and "from the motion of rigid" in known.how

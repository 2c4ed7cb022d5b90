"""References of other goals: the scene's own where nothing is off; refused where a goal is no rest point."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.simulation.control_period import reference
from pliant.envs.simulation.drawn_goals import goal_references


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach"])
def test_no_offset_gives_the_scenes_own(name: str) -> None:
    scene = scenes.get(name)
    found = goal_references(scene, np.zeros((2, len(scene.goal))))
    np.testing.assert_allclose(found, np.tile(reference(scene), (2, 1)), atol=1e-8)


def test_goals_that_move_are_refused() -> None:
    spin = scenes.get("spin-up")
    with pytest.raises(ValueError, match="goal_spread must be 0"):
        goal_references(spin, np.zeros((1, len(spin.goal))))

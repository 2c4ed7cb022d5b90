"""Where a linear model was made, in words."""

import pytest

from pliant.envs import scenes
from pliant.studies.common import operating_point


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("spacecraft-slew", "at rest with torque_x = 0 N m"),
        ("spacecraft-spin", "in steady motion with"),
        ("spacecraft-orbit", "at a point that is no equilibrium (d(eta1_1_rate)/dt = 4.1"),
    ],
)
def test_words_for_the_goal(name, says):
    """A spin is no rest, and sunlight bends the panels of a goal that moves on as it should."""
    scene = scenes.get(name)
    assert operating_point.words(scene.goal_model, scene.plant).startswith(says)


def test_rounding_is_no_torque():
    """Joints that turn about the vertical hold nothing."""
    scene = scenes.get("six-axis-pick")
    said = operating_point.words(scene.goal_model, scene.plant)
    assert "pan_torque = 0 N m" in said and "lift_torque = -54.5" in said

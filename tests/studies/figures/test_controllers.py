"""The picture of controllers side by side."""

import pytest

from pliant.envs import scenes
from pliant.studies.closed_loop.comparison import compare
from pliant.studies.figures.controllers import controllers

SLEW = scenes.get("single-link-slew")


@pytest.fixture(scope="module")
def slew():
    return compare(SLEW)


def test_picture_shows_goal_deflection_and_input(slew):
    drawn = controllers(SLEW, slew)
    labels = [ax.get_ylabel() for ax in drawn.axes]
    assert labels == ["hub angle\n[rad]", "tip deflection\n[m]", "hub torque\n[N m]"]
    words = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert words[:3] == ["LQR", "MPC", "trained policy"] and words[3] == f"on {SLEW.plant.label}"

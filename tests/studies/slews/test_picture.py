"""The picture of slews: a line for each in each panel, in words what each asks and leaves."""

import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.studies.figures.style import COLOURS
from pliant.studies.slews import Slew, slews_picture


def made_up(profile: str) -> Slew:
    arm = SingleLinkArm.textbook()
    motion = arm.simulate(arm.rest_state, lambda t: np.zeros(arm.nu), np.linspace(0.0, 1.0, 5))
    return Slew(profile, motion, 2.5, np.full(5, 0.25), 0.25, 0.5)


def test_three_panels() -> None:
    figure = slews_picture([made_up("bang-bang"), made_up("jerk-limited")], "hub_angle")
    assert [len(axes.get_lines()) for axes in figure.axes] == [3, 3, 3]  # with the motion's end
    words = [text.get_text() for axes in figure.axes if axes.get_legend() for text in axes.get_legend().get_texts()]
    assert "bang-bang, largest 2.5" in words and "jerk-limited, 0.25 J left" in words


def test_more_slews_than_colours() -> None:
    many = len(COLOURS) + 2
    figure = slews_picture([made_up(f"profile {k}") for k in range(many)], "hub_angle")
    assert [len(axes.get_lines()) for axes in figure.axes] == [many + 1] * 3
    assert figure.axes[0].get_legend().get_texts()[-1].get_text() == f"profile {many - 1}, largest 2.5"


def test_no_slews() -> None:
    with pytest.raises(ValueError, match="at least one"):
        slews_picture([], "hub_angle")

"""Every picture says how many times as large as they are deflections are drawn."""

import pytest

from pliant.envs import scenes
from pliant.envs.rendering import renderer
from pliant.envs.rendering.captions import caption


def test_what_it_says():
    assert caption(scenes.get("spin-up")) == "spin-up\nstiffened, clamped-free 2\ndeflections x 1"


@pytest.mark.parametrize(("name", "times"), [("two-link-reach", "1"), ("crane-swing", "1"), ("spacecraft-slew", "20")])
def test_it_stands_in_the_picture(name, times):
    """In the plane, in space and of a spacecraft, whose panels bend by millimetres."""
    picture = renderer(scenes.get(name))
    words = [text.get_text() for axes in picture.figure.axes for text in axes.texts]
    picture.close()
    [said] = [line for text in words for line in text.splitlines() if line.startswith("deflections x ")]
    assert said == f"deflections x {times}"

"""What a comparison of slews holds, and what it refuses."""

import dataclasses

import numpy as np
import pytest
from data_sheet_craft import scene

from pliant.controllers.joint_control.input_shaping import shaper as shaper_of
from pliant.studies.slews import compare_slews

SCENE = dataclasses.replace(scene(20.0), move_time=8.0)  # a turn of 5 degrees about x
FREE = 0.83051738  # [rad/s] of its first mode


@pytest.mark.campaign
def test_each_profile_ends_at_the_goal_and_a_shaper_calms_it() -> None:
    shaper = shaper_of(FREE)
    plain = compare_slews(SCENE, ("bang-bang",), points=60)[0]
    assert plain.ends == SCENE.move_time and plain.left > 0 and len(plain.energy) == 60
    calm = compare_slews(SCENE, ("bang-bang",), shaper=shaper, points=60)[0]
    assert calm.ends == pytest.approx(SCENE.move_time + shaper.duration) and calm.left < 0.1 * plain.left
    assert calm.motion["attitude_x"][0] == pytest.approx(-np.deg2rad(5.0), rel=1e-2)
    assert abs(calm.motion["attitude_x"][-1]) < 1e-3
    assert plain.largest == np.abs(plain.motion.u).max()


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"profiles": ("quick",)}, "profile"),
        ({"profiles": ()}, "at least one"),
        ({"scene": dataclasses.replace(SCENE, duration=SCENE.move_time)}, "duration"),
        ({"shaper": 3.0}, "shaper"),
    ],
)
def test_bad_input_is_named(options, word) -> None:
    with pytest.raises(ValueError, match=word):
        compare_slews(**({"scene": SCENE} | options))

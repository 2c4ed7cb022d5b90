"""LQG over a box: stable at its corners where the plain one is not; what it is made of; gates."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQG, RobustLQG, robust_lqg
from pliant.controllers.robust_design.lqg_over_box import loops_over
from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.rollout import nominal, rollout

REACH, SLEW = scenes.get("two-link-reach"), scenes.get("single-link-slew")


def test_it_lasts_where_the_plain_lqg_does_not():
    """Two-link-reach at a corner of +-30 %: one search on three parameters, a short one."""
    found = robust_lqg(REACH, ranges={"payload.mass": (0.7, 1.3), "link1.E": (0.7, 1.3), "link2.E": (0.7, 1.3)},
                       delays=(0,), iterations=25)  # fmt: skip
    assert isinstance(found, RobustLQG) and found.radius < 1 and np.isfinite(found.cost)
    assert set(found.parameters) == {"payload.mass", "link1.E", "link2.E"} and min(found.parameters.values()) > 0
    played = play(REACH)
    p = played.varied_plant.nominal_parameters * np.array([0.72, 0.71, 1.19, 1.25, 1.06])
    given = dataclasses.replace(nominal(played), p=p)
    assert (
        rollout(played, LQG.for_scene(REACH, uncertain=0.0), given).failure
        and not rollout(played, found.law, given).failure
    )


def test_it_is_an_lqg_whose_filter_is_the_optimum_for_its_noises():
    """Separation: the loop on its own model has the poles of law and filter, all within the unit circle."""
    found = robust_lqg(SLEW, ranges={"link.E": (0.8, 1.2)}, delays=(0,), iterations=5)
    assert np.abs(found.law.filter.poles).max() < 1 and np.abs(found.law.law.poles).max() < 1
    own = loops_over(SLEW, found.law.filter.sensors, [SLEW.plant.feedback_model(*SLEW.target)], (0,)).value(found.law)
    assert own.radius == pytest.approx(max(np.abs(found.law.filter.poles).max(), np.abs(found.law.law.poles).max()))


def test_bad_input():
    with pytest.raises(ValueError, match=r"robust_lqg\.ranges"):
        robust_lqg(SLEW, ranges={"link.E": (1.3, 0.7)})
    with pytest.raises(ValueError, match=r"robust_lqg\.delays"):
        robust_lqg(SLEW, delays=(-1,))
    with pytest.raises(PliantError, match="no point of all states"):
        robust_lqg(scenes.get("spin-up"))
    with pytest.raises(PliantError, match=r"stable at all corners|no law for all delays|that stays"):
        robust_lqg(SLEW, delays=(0, 16), iterations=1)

"""A law that fails on a vertex is replaced by one that fails on none; one that lasts is left as it is."""

import math

import pytest

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.studies import robustify
from pliant.studies.closed_loop.rollout import nominal, rollout

SLEW = scenes.get("single-link-slew")
TIGHT = scenes.get("single-link-slew", bounds=(("tip_deflection", 0.012), ("hub_angle_rate", 12.0)))
BOX = {"payload.mass": (0.7, 1.3)}


def test_a_law_that_lasts_is_left_as_it_is():
    law = LQR.for_scene(SLEW)
    found = robustify(law, SLEW, BOX, delays=(0,))
    assert found.law is law and found.price == 1.0 and len(found.attempts) == 1
    assert found.attempts[0].vertices == 3 and found.attempts[0].failures == 0
    assert found.attempts[0].nominal == pytest.approx(rollout(SLEW, law, nominal(SLEW)).cost)


def test_a_law_that_bends_too_far_is_detuned_or_designed_again_and_the_price_told():
    found = robustify(LQR.for_scene, TIGHT, BOX, delays=(0,), noise=False, efforts=(1, 3, 10, 30, 100))
    first = found.attempts[0]
    assert first.failures == first.vertices == 3 and "tip_deflection beyond its bound" in first.reason
    assert found.lasted and found.chosen.failures == 0
    assert {a.how for a in found.attempts} == {"as it is", "detuned", "redesigned"}
    assert found.chosen.mean == min(a.mean for a in found.attempts if not a.failures)
    assert found.price < 1  # the first failed, which is charged
    assert str(found).endswith("times what the first law does")


def test_a_made_law_cannot_be_detuned_and_none_may_last():
    found = robustify(LQR.for_scene(TIGHT), TIGHT, BOX, delays=(0,), redesign=False)
    assert not found.lasted and math.isnan(found.price) and len(found.attempts) == 1
    assert str(found).endswith("none lasted")


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match=r"robustify.efforts = \(-1.0,\)"):
        robustify(LQR.for_scene, SLEW, BOX, efforts=(-1.0,))
    with pytest.raises(ValueError, match=r"robustify\.law"):
        robustify(3, SLEW, BOX)
    with pytest.raises(ValueError, match=r"robustify.ranges\['payload.mass'\]"):
        robustify(LQR.for_scene, SLEW, {"payload.mass": (1.3, 0.7)})

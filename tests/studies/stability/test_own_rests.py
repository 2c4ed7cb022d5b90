"""Where a loop rests with other parameters, by hand and in motion."""

import dataclasses
import re

import numpy as np
from hoist import Hoist

from pliant.controllers import LQR
from pliant.envs.scenes.scene import Scene
from pliant.studies.stability.over_ranges import over_ranges
from pliant.studies.stability.own_rests import _rest, own_rests

SOFT = Scene(  # a rope that is held softly, a sway that is held so hard that a period of 0.3 s nearly grows
    name="hoist",
    about="",
    plant=Hoist(),
    start=(("sway", 0.0), ("rope", 4.0)),
    goal=(("sway", 0.0), ("rope", 4.0)),
    duration=30.0,
    dt=0.3,
    move_time=3.0,
    limits=(60.0, 900.0),
    weights=(("rope", 5.0), ("sway", 1e5)),
    effort=(("pull", 1.0), ("wind", 1e-2)),
    randomise=(("mass", 0.7, 1.3),),
    compare=("load_y",),
)


def test_a_softer_or_heavier_load_hangs_where_the_gain_holds_it():
    """m g = m0 g + k (rope - rope0), k the gain from the rope's length to its pull."""
    law, varied = LQR.for_scene(SOFT), SOFT.plant.vary("mass")
    x0, u0 = SOFT.target
    for mass in (0.8, 1.2):
        x = _rest(varied, law, x0, x0, u0, np.array([mass]))
        assert np.allclose(x, [4.0 + (mass - 1.0) * 9.81 / law.K[0, 0], 0.0, 0.0, 0.0], atol=1e-8)


def test_a_loop_that_grows_at_its_own_rest_is_told_and_grows_in_motion():
    """About the goal, where a lighter load does not rest, the linear loop decays; the motion does not."""
    told = over_ranges(SOFT)
    assert told.startswith("LQR about the goal is not stable for all mass 0.7 to 1.3 times its own: with mass = ")
    assert "it rests at rope = " in told and "not at 4, and grows there at " in told
    law = LQR.for_scene(SOFT)
    light = dataclasses.replace(SOFT.plant, mass=0.7)
    x = np.array(_rest(SOFT.plant.vary("mass"), law, SOFT.target[0], *SOFT.target, np.array([0.7])))
    x[1] += 1e-3
    sway = light.simulate(x, law, SOFT.times)["sway"]
    assert np.abs(sway[-20:]).max() > 20 * 1e-3
    calm = dataclasses.replace(SOFT, weights=(("rope", 5.0), ("sway", 1.0)))
    assert re.search(r"0.7 to 1.3 times its own; margin: [\d.]+ times these ranges, but with mass", over_ranges(calm))
    stiff = dataclasses.replace(SOFT, weights=(("rope", 500.0), ("sway", 1.0)))
    assert "at the ends the loop's own rests are stable too" in over_ranges(stiff)


def test_a_rest_that_stays_has_nothing_to_tell():
    """No gravity: whatever the parameters are, it rests where it is."""
    slew = dataclasses.replace(SOFT, plant=Hoist())
    law = LQR.for_scene(slew)
    assert own_rests(slew.plant, law, {"mass": (0.999999999, 1.000000001)}, slew.target).moved is False

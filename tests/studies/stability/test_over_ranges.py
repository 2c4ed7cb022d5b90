"""What a regulator stands of a scene's own ranges."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.controllers.analysis.loops import closed_loop
from pliant.envs import scenes
from pliant.plants.core import parameters
from pliant.studies.stability.over_ranges import over_ranges


@pytest.mark.parametrize("name", ["two-link-reach", "flexible-joint-slew"])
def test_what_is_told_is_so_at_random_parameters(name):
    scene = scenes.get(name)
    told = over_ranges(scene)
    assert told.startswith("LQR about the goal is stable for all payload.mass 0.7 to 1.3") and "margin: 3 times" in told
    law, rng = LQR.for_scene(scene), np.random.default_rng(0)
    rest, varied = scene.plant.equilibrium(dict(scene.goal)), scene.plant.vary("payload.mass")
    for factor in (0.1, 1.9, *rng.uniform(0.1, 1.9, 20)):  # three times the ranges
        model = varied.linearize(*rest, p=np.array([factor * parameters.get(scene.plant, "payload.mass")]))
        assert np.abs(np.linalg.eigvals(closed_loop(model, law))).max() < 1


def test_a_loop_that_does_not_stand_its_ranges_is_not_told_to():
    scene = dataclasses.replace(scenes.get("crane-swing"), randomise=(("payload.mass", 0.1, 3.5),))
    assert "not shown to be stable" in over_ranges(scene)


def test_scenes_without_ranges_or_a_rest_have_no_sentence():
    assert over_ranges(dataclasses.replace(scenes.get("two-link-reach"), randomise=())) == ""
    assert over_ranges(scenes.get("slider-crank-run")) == ""

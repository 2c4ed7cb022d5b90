"""The lines of an arm as they are drawn."""

import numpy as np

from pliant.envs import scenes
from pliant.studies.figures import arm_outline


def test_shapes_are_seen_from_a_hub_that_whirls():
    scene = scenes.get("spin-up", duration=10.0)
    motion = scene.open_loop(rtol=1e-6, atol=1e-8)
    assert arm_outline.whirls(scene.plant, motion)
    seen = arm_outline.lines(scene.plant, motion.x[::50], 5, from_hub=True)
    np.testing.assert_allclose(seen[:, -1, 1], motion["tip_deflection"][::50], atol=1e-9)
    assert (seen[:, -1, 0] > 9.9).all()

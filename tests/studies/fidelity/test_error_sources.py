"""Sources of an output's error, by the transpose, against the same steps taken forward and against other motions."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.error_sources import _output_slopes, error_sources
from pliant.studies.physics.physics_motion import physics_motion

SCENE = scenes.get("single-link-slew", duration=1.0, move_time=0.4)
AT = 0.35  # [s]


@pytest.fixture(scope="module")
def found():
    return error_sources(SCENE, AT)


def test_the_transpose_agrees_with_the_steps_taken_forward_to_rounding(found):
    motions = Motions(SCENE)
    known = physics_motion(motions, SCENE.tolerance)
    k = int(np.argmin(abs(SCENE.times - AT)))
    slopes, motion = _output_slopes(motions, known.motion, k), known.motion
    assert found.changes
    for name, change in found.changes.items():
        c = motion.lacked_by(known.physics.without(name)) - motion.lacked_by(known.physics)
        delta = motion.collocation().response(c, np.zeros(c.shape[-1]))[0][motion.nodes.control[k]]
        moved = change - found.measured[name]
        np.testing.assert_allclose(moved, slopes @ delta, rtol=1e-8, atol=1e-12 * abs(change).max())
        np.testing.assert_allclose(found.over_time[name].sum(axis=0), moved, rtol=1e-9, atol=1e-15)


def test_changes_are_those_of_motions_without_the_effect(found):
    """Simulated: exact rotations and shear move this link little, so that first order is all but everything."""
    motions = Motions(SCENE)
    physics = physics_motion(motions, SCENE.tolerance).physics
    k = int(np.argmin(abs(SCENE.times - AT)))
    whole = motions.outputs(physics, 1e-9)[k]
    for name, change in found.changes.items():
        apart = motions.outputs(physics.without(name), 1e-9)[k] - whole
        np.testing.assert_allclose(change, apart, rtol=0.1, atol=0.02 * abs(apart).max())
    assert "bending" in found.unseen
    assert found.to_json()["time"] == found.time == pytest.approx(AT, abs=SCENE.dt / 2)


def test_a_time_outside_the_scene_is_refused():
    with pytest.raises(ValueError, match=r"error_sources.time = 1.5 must be within"):
        error_sources(SCENE, 1.5)

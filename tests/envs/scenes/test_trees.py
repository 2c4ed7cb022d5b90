"""Scenes of trees in space: where their nominal inputs take them, and what a free satellite keeps."""

import numpy as np
import pytest

from pliant.envs import scenes


def played(name: str):
    scene = scenes.get(name)
    return scene, scene.open_loop(method="rk4", step=scene.dt / scene.substeps)


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "apart"), [("six-axis-pick", 0.03), ("three-link-flexible", 0.15)])
def test_the_nominal_inputs_take_the_joints_about_to_the_goal(name: str, apart: float) -> None:
    """The inputs are those of the rigid arm: what bends is a few hundredths of a radian, and the strips a tenth."""
    scene, motion = played(name)
    assert max(abs(motion[joint][-1] - goal) for joint, goal in scene.goal) < apart
    assert (np.abs(motion.u).max(axis=0) < scene.limits).all()
    assert all(np.abs(motion[signal]).max() < bound for signal, bound in scene.bounds)


@pytest.mark.campaign
def test_nothing_moves_the_satellite_but_what_its_arm_takes() -> None:
    """No force from outside: the mass centre of base (400 kg), wheels (3 x 3), rods and payload (10) stays, so that the
    base moves against the payload by at most their masses' ratio.
    """
    scene, motion = played("satellite-arm")
    rods = sum(b.beam.mass for b in scene.plant.slender)
    base = np.column_stack([motion[f"base_{axis}"] for axis in "xyz"])
    tip = np.column_stack([motion[f"tip_{axis}"] for axis in "xyz"])
    moved, of_tip = base[-1] - base[0], tip[-1] - tip[0]
    assert 0 < np.linalg.norm(moved) < (10.0 + rods) / 409.0 * np.linalg.norm(of_tip) + 1e-3
    assert moved @ of_tip < 0 and np.abs(base[:, 2]).max() < 1e-9  # against it, and in the plane
    assert abs(motion["base_attitude_z"][-1]) > 0.1  # no wheel has turned it back


def test_trees_are_drawn_in_space_and_reach_their_goals() -> None:
    """What each scene asks for is a rest of its machine, its joints where they were asked for."""
    for name in ("six-axis-pick", "three-link-flexible", "satellite-arm"):
        scene = scenes.get(name)
        values = scene.goal_values(tuple(joint for joint, _ in scene.goal))
        np.testing.assert_allclose(values, [value for _, value in scene.goal])
        assert scene.plant.drawn_as == "tree" and np.abs(scene.plant.dynamics(*scene.target)).max() < 1e-6

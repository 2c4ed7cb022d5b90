"""A scene as a whole: an early end never pays, copies are the same scene, environments of it."""

import dataclasses
import pickle

import gymnasium
import numpy as np
import pytest

import pliant.envs
from pliant.envs import scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

IDS = [pliant.envs.environment_id(name) for name in scenes.names()]


@pytest.mark.every(4)
@pytest.mark.parametrize("env_id", IDS)
def test_ending_costs_more_than_going_on(env_id: str) -> None:
    """Anywhere on the open-loop motion, the charge for the time left exceeds what the motion still costs."""
    scene = gymnasium.make(env_id).unwrapped.scene
    motion = scene.open_loop(method="rk4", step=scene.dt / scene.substeps)
    costs = scene.dt * scene.stage_cost(motion.x, motion.u, motion.y, motion.t)[:-1]
    to_go = np.cumsum(costs[::-1])[::-1]
    left = scene.steps - 1 - np.arange(scene.steps)
    charged = left * (scene.dt * scene.early_end_rate + costs)
    assert (charged[:-1] > to_go[1:]).all()


def test_a_copy_is_the_same_scene_and_its_environments_are_those_of_the_folder() -> None:
    scene = scenes.get("single-link-slew", duration=1.0)
    assert pickle.loads(pickle.dumps(scene)) == scene and hash(scene) == hash(dataclasses.replace(scene))
    made = scene.vector_env(3, randomise=True, dtype="float32", threads=1)
    assert isinstance(made, PlantVectorEnv) and made.num_envs == 3 and made.randomise
    assert made.single_observation_space.dtype == np.float32 and made.scene is scene


def test_points_are_given_by_name() -> None:
    """A crank at 144 rpm: 4.8 pi rad/s, everything else at zero; a goal that moves drifts by its rates."""
    scene = scenes.get("slider-crank-run")
    x, u = scene.initial
    at = scene.positions(["crank_angle_rate"])[0]
    assert x[at] == pytest.approx(4.8 * np.pi) and not np.delete(x, at).any() and not u.any()
    orbit = scenes.get("spacecraft-orbit")
    assert orbit.goal_drift(("hinge1_1", "hinge2_1", "attitude_y")) == pytest.approx([1.1e-3, -1.1e-3, 0.0])
    with pytest.raises(ValueError, match="start 'tip' must be one of crank_angle"):
        dataclasses.replace(scene, start=(("tip", 1.0),))

"""The control period on lanes: a goal that moves is where it then is, in each lane."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.environments.env import PlantEnv
from pliant.envs.environments.vector_env import PlantVectorEnv


def test_a_goal_that_moves_is_what_observations_are_measured_from():
    scene = scenes.get("spacecraft-orbit", duration=600.0)
    env = PlantEnv(scene)
    env.reset(options={"state": scene.target[0]})
    for _ in range(scene.steps):
        obs, reward, terminated, *_ = env.step(np.zeros(scene.plant.nu))
        assert not terminated and np.abs(obs).max() < 5e-3 and -1e-3 < reward <= 0  # it librates a little
        assert np.abs(obs[6:10]).max() < 1e-12  # hinges and their rates
    hinge = scene.plant.states.index(next(s for s in scene.plant.states if s.name == "hinge1_1"))
    assert env.state[hinge] == pytest.approx(1.1e-3 * 600.0, rel=1e-9)


def test_lanes_have_their_own_time():
    """A lane that starts later sees the goal and the sun where they are in its own episode."""
    scene = scenes.get("spacecraft-orbit", duration=3000.0)
    single, vector = PlantEnv(scene), PlantVectorEnv(scene, 3)
    vector.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(150):
        vector.step(rng.uniform(-0.2, 0.2, (3, scene.plant.nu)))
    vector.reset(options={"reset_mask": np.array([False, True, False])})
    single.reset(seed=0)
    for _ in range(150):
        actions = rng.uniform(-0.2, 0.2, (3, scene.plant.nu))
        many, one = vector.step(actions), single.step(actions[1])
        np.testing.assert_array_equal(many[0][1], one[0])
        assert many[1][1] == one[1]

"""What a task is made of keywords: difficulties, readings, bad ones refused by name."""

import gymnasium
import numpy as np
import pytest

from pliant.envs import Task, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.plants.sensing.sensors import sensors_of

SLEW = scenes.get("single-link-slew")


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"reward": "sparse"}, "reward"),
        ({"difficulty": "easy"}, "difficulty"),
        ({"constraint": 1}, "constraint"),
        ({"noise": -0.1}, r"Task.noise"),
        ({"noise": np.nan}, r"Task.noise"),
        ({"history": 101}, "history"),
        ({"action_delay": -1}, "action_delay"),
        ({"action_delay": (2, 1)}, "least first"),
        ({"observation_delay": (1, 2, 3)}, r"\(least, most\)"),
        ({"goal_spread": "wide"}, "goal_spread"),
        ({"sensors": 1}, "sensors"),
        ({"terms": None}, "terms"),
    ],
)
def test_what_is_refused(given, says) -> None:
    with pytest.raises(ValueError, match=says):
        Task(**given)


def test_difficulties() -> None:
    assert not Task(difficulty="nominal").drawn(False) and Task(difficulty="randomised").drawn(False)
    with pytest.raises(ValueError, match="nominal"):
        Task(difficulty="nominal").drawn(True)
    hard = Task(difficulty="hard")
    assert hard.action_delay == (0, 1) and hard.noise == 0.01
    assert Task(difficulty="hard", noise=0.0, action_delay=2).action_delay == (2, 2)
    ranges = {name: pair for name, *pair in hard.played(SLEW).randomise}
    assert all(ranges[name] == [0.7, 1.3] for name in SLEW.plant.uncertain if name in ranges)
    assert ranges["payload.mass"] == [0.7, 1.3] and Task().played(SLEW) is SLEW


def test_readings_are_the_plants_own_sensors_with_their_noise() -> None:
    """Standard deviations of the data sheet, from 40 lanes' first readings against the exact outputs."""
    sensors = sensors_of(SLEW.plant)
    env = PlantVectorEnv(SLEW, 400, sensors=True)
    obs, _ = env.reset(seed=0)
    exact = SLEW.plant.measure(*SLEW.initial)
    scene = env.scene
    assert scene.observe == tuple(sensor.output for sensor in sensors)
    at_start = scene.signal_values(SLEW.initial[0], exact, scene.observe) - scene.goal_values(scene.observe)
    want = np.array([sensor.deviation(SLEW.dt) for sensor in sensors])
    assert (obs - at_start).std(axis=0) == pytest.approx(want, rel=0.15)
    assert np.abs((obs - at_start).mean(axis=0) / want).max() < 0.2


def test_by_id_and_by_keyword() -> None:
    env = gymnasium.make("pliant/TwoLinkReachWeak-v0", reward="normalised", history=2, action_delay=[0, 1])
    assert env.observation_space.shape == (8 + 2 * (8 + 2),)
    assert env.unwrapped.scene.limits == (40.0, 10.0)
    assert gymnasium.make(env.spec.to_json() and env.spec).observation_space == env.observation_space
    with pytest.raises(TypeError, match="memory"):
        gymnasium.make("pliant/TwoLinkReach-v0", memory=2)

"""Attributes and methods by lane, as Gymnasium's and SB3's vector environments of single ones have them."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

SCENE = scenes.get("single-link-slew", duration=0.1)


@pytest.fixture
def vector() -> PlantVectorEnv:
    made = PlantVectorEnv(SCENE, 3, randomise=True)
    made.reset(seed=5)
    return made


def test_a_lanes_own_attributes_are_those_of_the_single_environment(vector) -> None:
    vector.step(np.full((3, 1), 0.5))
    for lane, (state, time, space) in enumerate(zip(*map(vector.get_attr, ("state", "time", "observation_space")))):
        single = PlantEnv(SCENE, randomise=True)
        single.reset(seed=5 + lane)
        single.step(np.full(1, 0.5))
        assert np.array_equal(single.state, state) and single.time == time and single.observation_space == space
    assert vector.get_attr("scene") == (SCENE,) * 3 == vector.call("scene")
    vector.get_attr("state")[0][:] = 9.0
    assert vector.states[0, 0] != 9.0
    with pytest.raises(AttributeError):
        vector.get_attr("nothing")


def test_what_a_user_sets_is_the_lanes_own(vector) -> None:
    vector.set_attr("mark", [1, 2, 3])
    assert vector.get_attr("mark") == (1, 2, 3)
    vector.set_lane_attr("other", ["a"], [1])
    assert vector.lane_attr("other", [1]) == ["a"]
    with pytest.raises(AttributeError, match="not set in all"):
        vector.get_attr("other")
    for name in ("scene", "num_envs", "state", "states", "autoreset_mode"):
        with pytest.raises(ValueError, match="is fixed when"):
            vector.set_attr(name, 1)
    with pytest.raises(ValueError, match="2 values must be one for all lanes, or 3"):
        vector.set_attr("mark", [1, 2])
    vector.set_attr("randomise", False)
    assert vector.randomise is False
    with pytest.raises(ValueError, match="which share it"):
        vector.set_lane_attr("randomise", [True], [0])


def test_a_method_acts_on_the_lanes_named_or_is_refused(vector) -> None:
    before = vector.states
    ((obs, info),) = vector.call_lanes("reset", [1], seed=8)
    single = PlantEnv(SCENE, randomise=True)
    wanted, told = single.reset(seed=8)
    assert np.array_equal(obs, wanted) and info["parameters"] == told["parameters"]
    assert np.array_equal(vector.states[[0, 2]], before[[0, 2]])
    assert vector.call_lanes("get_wrapper_attr", [2], "randomise") == [True]
    assert vector.call_lanes("has_wrapper_attr", [0, 1], "nothing") == [False] * 2
    vector.set_lane_attr("mark", [1], [1])
    assert vector.call_lanes("has_wrapper_attr", [0, 1], "mark") == [False, True]
    assert vector.call_lanes("has_wrapper_attr", [0], "state") == [True]
    with pytest.raises(ValueError, match=r"close: acts on all lanes at once, cannot be called in lanes \[0\] alone"):
        vector.call_lanes("close", [0])
    with pytest.raises(ValueError, match="step: acts on all lanes"):
        vector.call("step", np.zeros((3, 1)))

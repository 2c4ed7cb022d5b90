"""Specifications that become JSON and make the environment again; max_episode_steps has its effect or is refused."""

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode

from pliant.envs import scenes

ID = "pliant/SingleLinkSlew-v0"
STEPS = scenes.get("single-link-slew").steps


@pytest.mark.parametrize("dtype", [np.float32, "float32", np.dtype("float32"), np.float64])
def test_a_scalar_type_becomes_json_and_comes_back(dtype) -> None:
    env = gymnasium.make(ID, dtype=dtype, randomise=np.True_)
    text = env.spec.to_json()
    again = gymnasium.make(EnvSpec.from_json(text))
    assert again.unwrapped.spec.kwargs == {
        "scene": "single-link-slew",
        "dtype": np.dtype(dtype).name,
        "randomise": True,
    }
    assert again.spec.to_json() == text
    a, b = env.reset(seed=3)[0], again.reset(seed=3)[0]
    assert np.array_equal(a, b) and a.dtype == b.dtype == np.dtype(dtype)


def test_a_vector_specification_comes_back() -> None:
    keywords = {"dtype": np.float32, "autoreset_mode": AutoresetMode.SAME_STEP, "max_episode_steps": np.int64(4)}
    env = gymnasium.make_vec(ID, num_envs=3, **keywords)
    again = gymnasium.make_vec(EnvSpec.from_json(env.spec.to_json()))
    assert again.num_envs == 3 and again.spec == env.spec
    assert env.spec.max_episode_steps == 4 and again.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP


def ends_after(env, action) -> int:
    env.reset(seed=0)
    for k in range(1, STEPS + 2):
        if np.all(env.step(action)[3]):
            return k
    return 0


def test_max_episode_steps_has_its_effect() -> None:
    assert gymnasium.make(ID).spec.max_episode_steps == STEPS == gymnasium.make_vec(ID, 2).spec.max_episode_steps
    short = gymnasium.make(ID, max_episode_steps=5)
    assert short.spec.max_episode_steps == 5 and ends_after(short, np.zeros(1)) == 5
    for mode in ("vector_entry_point", "sync"):
        many = gymnasium.make_vec(ID, num_envs=2, vectorization_mode=mode, max_episode_steps=5)
        assert ends_after(many, np.zeros((2, 1))) == 5
    with pytest.raises(ValueError, match=f"max_episode_steps = {STEPS + 1} must be an integer from 1 to {STEPS}"):
        gymnasium.make_vec(ID, num_envs=2, max_episode_steps=STEPS + 1)
    assert ends_after(gymnasium.make(ID, max_episode_steps=10 * STEPS), np.zeros(1)) == STEPS


def test_a_registration_with_a_limit_of_its_own() -> None:
    own = gymnasium.spec(ID)
    limited = EnvSpec(
        "Limited-v0", own.entry_point, max_episode_steps=3, kwargs=own.kwargs, vector_entry_point=own.vector_entry_point
    )
    assert ends_after(gymnasium.make(limited), np.zeros(1)) == 3
    assert ends_after(gymnasium.make_vec(limited, num_envs=2), np.zeros((2, 1))) == 3

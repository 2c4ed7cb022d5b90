"""Pictures of every scene, in the plane and in space."""

import gymnasium
import numpy as np
import pytest
from env_cases import SAMPLED, play


@pytest.mark.every(4)
@pytest.mark.parametrize("env_id", SAMPLED)
def test_pictures(env_id: str) -> None:
    env = gymnasium.make(env_id, render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    play(env, np.full((15, env.unwrapped.scene.plant.nu), 0.5, np.float32))
    second = env.render()
    assert first.shape == (600, 600, 3) and first.dtype == np.uint8
    assert (first != second).any() and len(np.unique(second.reshape(-1, 3), axis=0)) > 50
    assert env.unwrapped.metadata["render_fps"] == max(1, round(1 / env.unwrapped.scene.dt))
    env.close()

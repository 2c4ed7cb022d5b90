"""The environment inside PufferLib, where that is installed: alone, and as its own vectors hold several."""

import numpy as np
import pytest

from pliant.envs import scenes

pufferlib = pytest.importorskip("pufferlib")
vector = pytest.importorskip("pufferlib.vector")

SLEW = scenes.get("single-link-slew", duration=0.2)


def test_alone_it_makes_its_own_buffers() -> None:
    env = SLEW.puffer_env(4, reward="normalised")
    assert isinstance(env, pufferlib.PufferEnv) and env.num_agents == 4
    env.async_reset(1)
    env.send(np.zeros((4, 1), np.float32))
    obs, rewards, terminals, truncations, infos, agents, masks = env.recv()
    assert obs.shape == (4, 4) and (rewards > 0).all() and masks.all() and infos == []
    assert not terminals.any() and not truncations.any() and agents.tolist() == [0, 1, 2, 3]


def test_as_many_as_its_vector_holds() -> None:
    made = vector.make(SLEW.puffer_env, env_args=[3], env_kwargs={"randomise": True}, num_envs=2, backend=vector.Serial)
    obs, _ = made.reset(seed=5)
    assert obs.shape == (6, 4) and len(np.unique(obs[:, 0])) == 6
    for _ in range(SLEW.steps):
        obs, _, terminals, truncations, infos = made.step(np.zeros((6, 1), np.float32))
    assert truncations.all() and not terminals.any() and infos[0]["episode_length"] == SLEW.steps
    made.close()

"""The Stable-Baselines3 adapter: what its contract forces, under its own wrappers, beside the vector environment."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from pliant.envs import scenes
from pliant.envs.environments.sb3_env import PlantVecEnv
from pliant.envs.environments.vector_env import PlantVectorEnv

SHORT = scenes.get("single-link-slew", duration=0.1)


def test_steps_equal_the_vector_environment_and_episodes_end_as_the_contract_says() -> None:
    wrapped = PlantVecEnv(SHORT, 4, randomise=True, dtype=np.float64)
    plain = PlantVectorEnv(SHORT, 4, randomise=True, autoreset_mode="SameStep")
    wrapped.seed(3)
    assert np.array_equal(wrapped.reset(), plain.reset(seed=3)[0])
    rng = np.random.default_rng(0)
    for k in range(12):
        action = rng.uniform(-1, 1, (4, 1)).astype(np.float32)
        obs, rewards, dones, infos = wrapped.step(action)
        want, costs, terminated, truncated, ended = plain.step(action)
        assert np.array_equal(obs, want) and rewards.dtype == np.float32
        np.testing.assert_allclose(rewards, costs, rtol=1e-6)
        assert np.array_equal(dones, terminated | truncated)
        assert dones.all() == ((k + 1) % 5 == 0)
        for i in range(4):
            if dones[i]:
                assert np.array_equal(infos[i]["terminal_observation"], ended["final_obs"][i])
                assert infos[i]["TimeLimit.truncated"] is True and infos[i]["diverged"] is False
            else:
                assert infos[i] == {}


def test_termination_is_no_time_limit() -> None:
    env = PlantVecEnv(scenes.get("single-link-slew", bounds=(("hub_angle_rate", 0.5),)), 3)
    env.reset()
    for _ in range(50):
        _, _, dones, infos = env.step(np.ones((3, 1), dtype=np.float32))
        if dones.any():
            assert [i["TimeLimit.truncated"] for i in infos] == [False] * 3
            return
    pytest.fail("full torque never left a bound of 0.5 rad/s")


def test_under_monitor_and_normalisation() -> None:
    env = VecNormalize(VecMonitor(PlantVecEnv(SHORT, 8, randomise=True)))
    env.seed(0)
    obs = env.reset()
    returns, total = [], np.zeros(8)
    for _ in range(10):
        obs, _, dones, infos = env.step(np.full((8, 1), 0.2, dtype=np.float32))
        total += env.get_original_reward()
        assert np.isfinite(obs).all()
        for i in np.flatnonzero(dones):
            assert infos[i]["episode"]["l"] == 5
            assert infos[i]["episode"]["r"] == pytest.approx(total[i], rel=1e-4)
            returns.append(total[i])
            total[i] = 0.0
    assert len(returns) == 16


def test_attributes_and_methods() -> None:
    env = PlantVecEnv(SHORT, 3)
    assert env.get_attr("randomise") == [False] * 3
    assert env.get_attr("scene", indices=[0, 2]) == [SHORT] * 2
    env.set_attr("randomise", True)
    assert env.vector.randomise is True
    with pytest.raises(ValueError, match="must name all lanes"):
        env.set_attr("randomise", False, indices=[0])
    assert env.env_is_wrapped(VecMonitor) == [False] * 3
    assert env.get_attr("render_mode") == [None] * 3


def test_a_seed_serves_one_reset() -> None:
    env = PlantVecEnv(SHORT, 2, randomise=True)
    env.seed(1)
    first, second = env.reset(), env.reset()
    env.seed(1)
    assert np.array_equal(env.reset(), first) and not np.array_equal(first, second)


def test_ppo_learns_a_few_steps() -> None:
    from stable_baselines3 import PPO

    model = PPO("MlpPolicy", PlantVecEnv(SHORT, 16, randomise=True), n_steps=8, batch_size=64, seed=0, device="cpu")
    model.learn(256)
    assert model.num_timesteps == 256

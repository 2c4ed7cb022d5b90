"""A network of Stable-Baselines3 as NumPy runs it."""

import numpy as np
import pytest

from pliant.controllers import Policy
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")


@pytest.mark.every(2)
@pytest.mark.parametrize("algorithm", ["ppo", "sac"])
def test_numpy_acts_as_torch_does(stable_baselines, tmp_path, algorithm):
    """A zip with normalised observations and as a Policy: 1e-6 of the limits."""
    import torch
    from stable_baselines3.common.vec_env import VecNormalize

    from pliant.controllers.learning.sb3_export import ALGORITHMS

    env = VecNormalize(SCENE.sb3_env(16, randomise=True), clip_obs=2.0)
    env.reset()
    for _ in range(5):
        env.step(np.full((16, 1), 0.5, dtype=np.float32))
    model = ALGORITHMS[algorithm]("MlpPolicy", env, seed=1, device="cpu")
    model.save(tmp_path / "model.zip")
    env.save(str(tmp_path / "statistics.pkl"))
    p = Policy.from_sb3_zip(
        tmp_path / "model.zip", SCENE, algorithm=algorithm, statistics=tmp_path / "statistics.pkl", trust=True
    )
    rng, points = np.random.default_rng(2), []
    for _ in range(50):
        obs = rng.normal(size=4)
        alone, _ = model.predict(env.normalize_obs(obs.astype(np.float32)[None]), deterministic=True)
        points.append((obs, alone[0], p.act(0.0, obs + p.goal)))
    model.policy.double()
    for obs, alone, u in points:
        z = torch.from_numpy(np.clip((obs - env.obs_rms.mean) / np.sqrt(env.obs_rms.var + env.epsilon), -2, 2))
        with torch.no_grad():
            if algorithm == "ppo":
                action = model.policy.action_net(model.policy.mlp_extractor.policy_net(z)).clamp(-1, 1)
            else:
                action = torch.tanh(model.policy.actor.mu(model.policy.actor.latent_pi(z)))
        assert np.abs(u / 40 - action.numpy()).max() < 1e-9
        assert np.abs(u / 40 - alone).max() < 1e-6  # through its own single precision
    assert len({float(u[0]) for *_, u in points}) > 20


@pytest.mark.parametrize("task", [{"hold": 3}, {"actions": "midway"}, {"actions": "nominal", "hold": 4}])
def test_a_law_plays_as_the_environment_that_it_was_trained_in(stable_baselines, tmp_path, task):
    """What is read after 24 control periods; and of the law once more from its file."""
    from stable_baselines3 import PPO

    scene = scenes.get("two-link-reach")
    model = PPO("MlpPolicy", scene.sb3_env(1, **task), seed=3, device="cpu")
    model.save(tmp_path / "model.zip")
    law = Policy.from_sb3_zip(tmp_path / "model.zip", scene, **task, trust=True)
    law.save(tmp_path / "law")
    env, played = scene.vector_env(1, **task), scene.vector_env(1)
    for acting in (law, Policy.load(tmp_path / "law")):
        acting.reset()
        (obs, _), (own, _) = env.reset(seed=0), played.reset(seed=0)
        for k in range(24):
            if k % task.get("hold", 1) == 0:
                action, _ = model.predict(obs.astype(np.float32), deterministic=True)
                obs, *_ = env.step(action)
            u = acting.act(k * scene.dt, np.asarray(own[0], dtype=float) + law.goal)
            own, *_ = played.step((u / scene.limits)[None])
        np.testing.assert_allclose(own, obs, rtol=0, atol=1e-5)
    assert np.abs(u / scene.limits).max() < 1


def test_zip_of_another_scene_is_refused(stable_baselines, tmp_path):
    from stable_baselines3 import PPO

    PPO("MlpPolicy", SCENE.sb3_env(1), device="cpu").save(tmp_path / "model.zip")
    with pytest.raises(ValueError, match="network from 4 to 1 numbers must be from 8 to 2"):
        Policy.from_sb3_zip(tmp_path / "model.zip", scenes.get("two-link-reach"), trust=True)


def test_damaged_and_foreign_zips_are_refused_by_name(stable_baselines, tmp_path):
    from stable_baselines3 import PPO

    PPO("MlpPolicy", SCENE.sb3_env(1), device="cpu").save(tmp_path / "model.zip")
    whole = (tmp_path / "model.zip").read_bytes()
    for content in (b"", b"no zip", whole[: len(whole) // 2], whole.replace(b"policy.pth", b"policy.xxx")):
        (tmp_path / "bad.zip").write_bytes(content)
        with pytest.raises(ValueError, match=r"Policy\.from_sb3_zip: '.*bad\.zip' cannot be read"):
            Policy.from_sb3_zip(tmp_path / "bad.zip", SCENE, trust=True)
    (tmp_path / "statistics.pkl").write_bytes(b"no pickle")
    with pytest.raises(ValueError, match=r"statistics\.pkl' cannot be read"):
        Policy.from_sb3_zip(tmp_path / "model.zip", SCENE, statistics=tmp_path / "statistics.pkl", trust=True)
    with pytest.raises(FileNotFoundError):
        Policy.from_sb3_zip(tmp_path / "none.zip", SCENE, trust=True)

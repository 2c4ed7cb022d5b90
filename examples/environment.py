"""Train-ready: one environment, or a thousand in one call."""

import gymnasium

import pliant.envs  # noqa: F401  (registers the ids)

env = gymnasium.make("pliant/TwoLinkReach-v0", randomise=True)
obs, info = env.reset(seed=0)
obs, reward, terminated, truncated, info = env.step(env.action_space.sample())
print(f"payload {info['parameters']['payload.mass']:.3f} kg, reward {reward:.3f}")

venv = gymnasium.make_vec("pliant/TwoLinkReach-v0", num_envs=1024, randomise=True)
obs, _ = venv.reset(seed=0)
obs, rewards, terminated, truncated, infos = venv.step(venv.action_space.sample())
print(f"{len(obs)} lanes, mean reward {rewards.mean():.3f}")

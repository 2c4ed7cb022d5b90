"""Learning: steps a second of PPO, whole iterations, and seconds of a gradient of analytic policy gradients."""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy and torch are loaded

from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np
from harness import sampling

from pliant.controllers import rl
from pliant.controllers.analytic_gradients.rollouts import Episodes, Rollouts
from pliant.controllers.analytic_gradients.step_adjoints import StepAdjoints
from pliant.envs import Scene, scenes
from pliant.envs.environments.env import PlantEnv
from pliant.plants.integration.step_sensitivities import StepSensitivities
from pliant.studies.commands import console
from pliant.studies.common import machine

GROUP, SCENE, LANES = "learning", "two-link-reach", 1024
PLIANT, SYNC = "PPO on Pliant's vector environment", "PPO on Gymnasium's SyncVectorEnv of the same environment"
GRADIENT, GRADIENT_LANES = "a gradient of whole episodes (apg): 150 periods, 12 states", 32
STEPS_BACK, STEPS_FORMED = "of it, the steps forward and backward", "the same steps with dx+/dx and dx+/du formed"


def sync_env(scene: Scene, num_envs: int) -> Any:
    """Gymnasium's SyncVectorEnv of the single environment, as Stable-Baselines3's VecEnv."""
    from gymnasium.vector import AutoresetMode, SyncVectorEnv
    from stable_baselines3.common.vec_env import VecEnv

    class Lanes(VecEnv):
        def __init__(self) -> None:
            make = partial(PlantEnv, scene, randomise=True, dtype=np.float32)
            self.render_mode = None
            self.vector = SyncVectorEnv([make] * num_envs, autoreset_mode=AutoresetMode.SAME_STEP)
            super().__init__(num_envs, self.vector.single_observation_space, self.vector.single_action_space)

        def reset(self) -> np.ndarray:
            return self.vector.reset(seed=0)[0]

        def step_async(self, actions: np.ndarray) -> None:
            self._actions = actions

        def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
            obs, rewards, terminated, truncated, ended = self.vector.step(self._actions)
            dones, infos = terminated | truncated, [{} for _ in range(num_envs)]
            for i in np.flatnonzero(dones):
                infos[i] = {
                    "terminal_observation": ended["final_obs"][i],
                    "TimeLimit.truncated": bool(truncated[i]),
                }
            return obs, rewards.astype(np.float32), dones, infos

        def close(self) -> None:
            self.vector.close()

        def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
            return [getattr(self, attr_name, None)] * num_envs

        def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
            raise NotImplementedError

        def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
            raise NotImplementedError

        def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
            return [False] * num_envs

    return Lanes()


def _ppo(make: Callable[[], Any], threads: int) -> sampling.Sampler:
    """Steps a second of whole iterations: rollout, inference, learning, with training's own settings."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.logger import Logger
    from stable_baselines3.common.vec_env import VecNormalize

    settings = rl.PPOSettings(num_envs=LANES)
    env = VecNormalize(make(), gamma=settings.gamma)
    model = PPO(
        "MlpPolicy",
        env,
        n_steps=settings.n_steps,
        batch_size=settings.batch_size,
        n_epochs=settings.n_epochs,
        learning_rate=settings.learning_rate,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        policy_kwargs={"net_arch": [settings.width] * 2, "log_std_init": float(np.log(settings.noise))},
        seed=0,
        device="cpu",
    )
    model.set_logger(Logger(None, []))

    def work() -> int:
        torch.set_num_threads(threads)
        before = model.num_timesteps
        model.learn(settings.n_steps * LANES, reset_num_timesteps=False)
        return model.num_timesteps - before

    return sampling.rate_of(work)


def _gradient(lanes: int) -> sampling.Sampler:
    """Seconds of a whole gradient of analytic policy gradients: forward, backward, 150 periods of 12 states."""
    scene = scenes.get(SCENE)
    rollouts = Rollouts(scene, lanes, np.ones(len(scene.observe)))
    theta = rollouts.network.start(np.random.default_rng(0))
    start, own = np.tile(scene.initial[0], (lanes, 1)), np.tile(scene.varied_plant.nominal_parameters, (lanes, 1))
    episodes = Episodes(start, own, np.zeros(lanes, dtype=int))
    return sampling.time_of(lambda: rollouts(theta, episodes))


def _stepped(lanes: int, formed: bool) -> sampling.Sampler:
    """Seconds of an episode's steps and of what takes slopes back through them, by adjoints or by derivatives."""
    scene = scenes.get(SCENE)
    plant, u = scene.varied_plant, np.zeros((lanes, scene.plant.nu))
    start, slope = np.tile(scene.initial[0], (lanes, 1)), np.ones((lanes, scene.plant.nx))
    own = {"substeps": scene.substeps, "batch": lanes}
    forward, derivatives = plant.stepper(scene.dt, check=False, **own), StepSensitivities(plant, scene.dt, **own)
    back = StepAdjoints(plant, scene.dt, **own)

    def by_derivatives() -> None:
        for _ in range(scene.steps):
            _, A, B = derivatives(start, u)
            np.matmul(slope[:, None], A), np.matmul(slope[:, None], B)

    def by_adjoints() -> None:
        for _ in range(scene.steps):
            forward(start, u)
            back(start, u, slope)

    return sampling.time_of(by_derivatives if formed else by_adjoints)


def cases() -> list[sampling.Case]:
    """PPO on both versions of the environment, with one torch thread and with all processors."""
    scene = scenes.get(SCENE)

    def case(name: str, make: Callable[[], Any], threads: int) -> sampling.Case:
        # Where Stable-Baselines3 is missing the row says so, as for a peer
        peer = partial(_ppo, make, threads)
        return sampling.Case(group=GROUP, name=name, prepare=peer, threads=threads, lanes=LANES, peer=True)

    counts = sorted({1, machine.cores()})
    ours = [case(PLIANT, partial(scene.sb3_env, LANES, randomise=True, threads=n), n) for n in counts]
    step = partial(_gradient, GRADIENT_LANES)
    made = {GRADIENT: step} | {
        name: partial(_stepped, GRADIENT_LANES, formed) for name, formed in ((STEPS_BACK, False), (STEPS_FORMED, True))
    }
    options = {"group": GROUP, "unit": sampling.TIME, "lanes": GRADIENT_LANES}
    own = [sampling.Case(name=name, prepare=prepare, **options) for name, prepare in made.items()]
    return [*ours, case(SYNC, partial(sync_env, scene, LANES), 1), *own]


def rows(quick: bool) -> list[dict[str, Any]]:
    """The fields of sampling.Row, one dictionary a row."""
    with console.bar("learning") as progress:
        return [asdict(row) for row in sampling.measure(cases(), 3 if quick else 5, 1.0 if quick else 4.0, progress)]

"""A training run: Stable-Baselines3's learner on a scene's lanes, evaluated and saved as it goes."""

from __future__ import annotations

import dataclasses
import random
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.vec_env import VecNormalize

from . import checkpoint
from .evaluation import Training
from .settings import FLOOR, PPOSettings, Progress, SACSettings
from .torch_threads import choose
from .training_callback import Run
from .training_env import TrainingLanes, normalised

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import TrainableScene

PACKAGES = ("pliant", "stable-baselines3", "torch", "numpy")


def learn(
    scene: TrainableScene,
    algorithm: str,
    settings: PPOSettings | SACSettings,
    *,
    seed: int,
    seconds: float | None,
    steps: int | None,
    folder: Path | None,
    resume: bool,
    threads: int | None,
    command: str,
    progress: Progress,
) -> Training:
    """`rl.train` with everything said."""
    begin = time.perf_counter()
    words: dict[str, Any] = {"stamp": 0}
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        if resume:
            words = checkpoint.read_words(folder)
        elif checkpoint.exists(folder):
            raise ValueError(f"train: folder = {str(folder)!r} holds a run: go on with resume=True, or name another")
    with _as_found():
        count, why = (threads, "as asked") if threads is not None else choose()
        torch.set_num_threads(count)
        spoken = f"{count} torch thread{'s' * (count > 1)}: {why}"
        progress(0.0, spoken)
        own_seed = (seed + words["stamp"]) % 2**32  # a run that goes on must not draw the same again
        lanes = TrainingLanes(
            scene,
            settings.num_envs,
            spread=settings.spread,
            bounded=algorithm == "sac",
            seed=own_seed,
            threads=count,
        )
        env = normalised(lanes)
        try:
            made = {
                "command": command,
                "scene": scene.name,
                "algorithm": algorithm,
                "seed": seed,
                "budget": {"seconds": seconds, "steps": steps},
                "settings": dataclasses.asdict(settings),
                "versions": {name: metadata.version(name) for name in PACKAGES},
            }
            run = Run(scene, env, folder, (seconds, steps), made, progress, begin)
            model = _model(settings, env, own_seed, run)
            model.set_logger(Logger(None, []))  # else one more folder for temporary files is made
            run.init_callback(model)
            if resume:
                run.resume(model, words)
                if isinstance(model, SAC):
                    model.learning_starts += model.num_timesteps
            _start(model, env, lanes, fresh=not resume)
            done = model.num_timesteps
            left = max(0, steps - done) if steps is not None else 10**15
            if run.share < 1 or run.best is None:  # a first look at least, where setting up has taken all the time
                model.learn(left, callback=run, reset_num_timesteps=False)
                took = time.perf_counter() - run.learning_since
                rate = (model.num_timesteps - run.first_steps) / took
                run.judge()
            else:
                rate = 0.0
        finally:
            env.close()
    progress(1.0, f"cost {run.best_cost:.4g}")
    assert run.best is not None
    return Training(run.best, run.best_cost, tuple(run.curve), model.num_timesteps, run.spent, rate, spoken)


def _model(settings: PPOSettings | SACSettings, env: VecNormalize, seed: int, run: Run) -> BaseAlgorithm:
    """The learner, its learning rate falling with the budget that `run` keeps."""

    def rate(_: float) -> float:
        started = getattr(run, "model", None) is not None
        return settings.learning_rate * max(FLOOR, 1 - run.share if started else 1.0)

    layers = {"net_arch": [settings.width] * 2}
    common: dict[str, Any] = {"learning_rate": rate, "gamma": settings.gamma, "seed": seed, "device": "cpu"}
    if isinstance(settings, PPOSettings):
        return PPO(
            "MlpPolicy",
            env,
            n_steps=settings.n_steps,
            batch_size=_divisor(settings.n_steps * settings.num_envs, settings.batch_size),
            n_epochs=settings.n_epochs,
            gae_lambda=settings.gae_lambda,
            clip_range=settings.clip_range,
            policy_kwargs={**layers, "log_std_init": float(np.log(settings.noise))},
            **common,
        )
    return SAC(
        "MlpPolicy",
        env,
        buffer_size=settings.buffer_size,
        batch_size=settings.batch_size,
        learning_starts=settings.learning_starts,
        train_freq=1,
        gradient_steps=settings.gradient_steps,
        tau=settings.tau,
        policy_kwargs=layers,
        **common,
    )


def _start(model: BaseAlgorithm, env: VecNormalize, lanes: TrainingLanes, *, fresh: bool) -> None:
    """Start the episodes: `model.learn` would do it too, but then forget num_timesteps."""
    obs = env.reset()
    if fresh:
        statistics: Any = env.obs_rms
        statistics.update(lanes.seen)
        obs = env.normalize_obs(lanes.last)
    model._last_obs = obs
    model._last_original_obs = env.get_original_obs()
    model._last_episode_starts = np.ones(env.num_envs, dtype=bool)


def _divisor(whole: int, most: int) -> int:
    """The largest divisor of `whole` that is at most `most`: batches that leave no rest."""
    return next(n for n in range(min(whole, most), 0, -1) if whole % n == 0)


@contextmanager
def _as_found() -> Iterator[None]:
    """Global generators and torch's threads as they were, whatever happens inside."""
    threads, state, numpy_state = torch.get_num_threads(), random.getstate(), np.random.get_state()  # noqa: NPY002
    try:
        with torch.random.fork_rng(devices=[]):
            yield
    finally:
        torch.set_num_threads(threads)
        random.setstate(state)
        np.random.set_state(numpy_state)  # noqa: NPY002

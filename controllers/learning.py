"""A training run: Stable-Baselines3's learner on a scene's lanes, evaluated and saved as it goes."""

from __future__ import annotations

import dataclasses
import json
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
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.vec_env import VecNormalize

from . import actor, checkpoint
from .lanes import TrainingLanes, normalised
from .policy import Policy
from .rl import CURVE, FLOOR, POLICY, Evaluation, PPOSettings, Progress, SACSettings, Training, evaluate
from .torch_threads import choose

if TYPE_CHECKING:
    from pliant.envs import Scene

EVALUATIONS = 60  # of a run
PACKAGES = ("pliant", "stable-baselines3", "torch", "numpy")


class Run(BaseCallback):
    """Keeps the budget, evaluates, saves. Its fields up to `spent` are what a checkpoint keeps besides the model."""

    def __init__(
        self,
        scene: Scene,
        env: VecNormalize,
        folder: Path | None,
        budget: tuple[float | None, int | None],
        made: dict[str, Any],
        progress: Progress,
        begin: float,
    ) -> None:
        super().__init__()
        self.scene, self.env, self.folder, self.made, self.progress = scene, env, folder, made, progress
        self.seconds, self.steps = budget
        self.curve: list[Evaluation] = []
        self.best: Policy | None = None
        self.best_cost = np.inf
        self.former = 0.0  # seconds of former runs
        self.begin = begin
        self.first_steps, self.learning_since = 0, begin
        self._judge = scene.vector_env(1, threads=1)
        self._told = 0.0

    @property
    def spent(self) -> float:
        """Seconds so far, former runs included."""
        return self.former + time.perf_counter() - self.begin

    @property
    def share(self) -> float:
        """Of the budget."""
        if self.steps is not None:
            return min(self.model.num_timesteps / self.steps, 1.0)
        assert self.seconds is not None
        return min(self.spent / self.seconds, 1.0)

    def resume(self, model: BaseAlgorithm, words: dict[str, Any]) -> None:
        """Go on from the folder's checkpoint. ValueError unless it is of the same scene and algorithm."""
        assert self.folder is not None
        for name in ("scene", "algorithm"):
            if words[name] != self.made[name]:
                raise ValueError(f"resume: the checkpoint's {name} = {words[name]!r} must be {self.made[name]!r}")
        checkpoint.restore(self.folder, words, model, self.env)
        self.curve = [Evaluation(**point) for point in words["curve"]]
        self.best_cost, self.former = words["best_cost"], words["spent"]
        self.best = Policy.load(self.folder / POLICY)

    def judge(self) -> None:
        """Evaluate the policy as it is; keep it if it is the best; save everything."""
        self._next = self.share + 1 / EVALUATIONS
        words = actor.describe(self.model, self.scene, self.env)
        policy = Policy(**words)
        cost = evaluate(policy, self.scene, self._judge)
        point = Evaluation(int(self.model.num_timesteps), round(self.spent, 2), cost)
        self.curve.append(point)
        better = cost < self.best_cost or self.best is None
        if better:
            made = {**self.made, **dataclasses.asdict(point)}
            self.best, self.best_cost = Policy(**words | {"made": made}), cost
        if self.folder is None:
            return
        if better and self.best is not None:
            self.best.save(self.folder / POLICY)
        kept = {
            "scene": self.made["scene"],
            "algorithm": self.made["algorithm"],
            "best_cost": self.best_cost,
            "spent": self.spent,
            "curve": [dataclasses.asdict(p) for p in self.curve],
        }
        checkpoint.save(self.folder, self.model, self.env, kept)
        (self.folder / CURVE).write_text(json.dumps(kept, indent=1, allow_nan=False) + "\n", encoding="utf-8")

    def _on_training_start(self) -> None:
        self.first_steps, self.learning_since = self.model.num_timesteps, time.perf_counter()
        self.judge()

    def _on_rollout_start(self) -> None:
        if self.share >= self._next:
            self.judge()
        now = time.perf_counter()
        if now - self._told > 0.2:
            self._told = now
            self.progress(self.share, f"{self.model.num_timesteps / 1e6:.2f} M steps, cost {self.best_cost:.4g}")

    def _on_step(self) -> bool:
        return self.seconds is None or self.spent < self.seconds


def learn(
    scene: Scene,
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
        elif (folder / checkpoint.WORDS).exists():
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
            run = Run(scene, env, folder, (seconds, steps), {}, progress, begin)
            model = _model(settings, env, own_seed, run)
            model.set_logger(Logger(None, []))  # else one more folder for temporary files is made
            run.init_callback(model)
            run.made = {
                "command": command,
                "scene": scene.name,
                "algorithm": algorithm,
                "seed": seed,
                "budget": {"seconds": seconds, "steps": steps},
                "settings": dataclasses.asdict(settings),
                "versions": {name: metadata.version(name) for name in PACKAGES},
            }
            if resume:
                run.resume(model, words)
                if isinstance(model, SAC):
                    model.learning_starts += model.num_timesteps
            model._last_obs = env.reset()  # episodes start here, not in `learn`, which would forget num_timesteps
            model._last_original_obs = env.get_original_obs()
            model._last_episode_starts = np.ones(env.num_envs, dtype=bool)
            if not resume:
                env.obs_rms.update(lanes.seen)  # type: ignore[union-attr]
                model._last_obs = env.normalize_obs(lanes.last)
            done = model.num_timesteps
            left = max(0, steps - done) if steps is not None else 10**15
            if run.share < 1:
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

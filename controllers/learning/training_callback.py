"""A training run as Stable-Baselines3 calls it: it keeps the budget, evaluates and saves."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecNormalize

from pliant.plants.files import sealed_json

from . import checkpoint, sb3_export
from .evaluation import Evaluation, evaluate
from .policy import Policy
from .settings import CURVE, CURVE_FORMAT, POLICY, Progress

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import TrainableScene

EVALUATIONS = 60  # of a run


class Run(BaseCallback):
    """One run on `env`, whose best policy so far is `best`; `made` goes into every policy, whatever it holds."""

    def __init__(
        self,
        scene: TrainableScene,
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
        self._next = self._told = 0.0

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
        # The policy's own files may be of another moment: of a run that was killed between them and the checkpoint.
        self.best = checkpoint.best_of(self.folder) or Policy.load(self.folder / POLICY)
        self._export()

    def judge(self) -> None:
        """Evaluate the policy as it is; keep it if it is the best; save everything."""
        self._next = self.share + 1 / EVALUATIONS
        words = sb3_export.describe(self.model, self.scene, self.env)
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
        assert self.best is not None
        checkpoint.save(self.folder, self.model, self.env, self._kept(), self.best)
        self._export(better)

    def _kept(self) -> dict[str, Any]:
        return {
            "scene": self.made["scene"],
            "algorithm": self.made["algorithm"],
            "best_cost": self.best_cost,
            "spent": self.spent,
            "curve": [dataclasses.asdict(p) for p in self.curve],
        }

    def _export(self, policy: bool = True) -> None:
        """What others read of the run; all of it follows from the checkpoint, which is written before."""
        assert self.folder is not None and self.best is not None
        if policy:
            self.best.save(self.folder / POLICY)
        sealed_json.save(self.folder / CURVE, {"format": CURVE_FORMAT, **self._kept()})

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

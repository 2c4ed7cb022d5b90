"""A scene's lanes as learning wants them: starts spread wide, episodes out of step, costs within a few units.

What the scene charges is what a policy is judged by; what it learns from differs in four ways.

Starts   are drawn farther from the scene's own, on both sides of the goal: a policy that only ever came from one
         side learns to push, not to brake.
Cost     is over `unit`, half a second's cost at the start. Below KNEE times the start's cost rate it is the
         scene's; above, it grows as the logarithm, so that runaway motions do not drown what matters.
Ends     an episode that leaves the bounds is charged EARLY_END units, in place of the scene's charge, which grows
         with the time left: the policy does not see that time.
Actions  beyond the limits are cut off by the plant and would have no slope there: EXCESS times their square is added.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.vec_env import VecEnvWrapper, VecNormalize

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import TrainableScene

KNEE, EARLY_END, EXCESS = 1.5, 10.0, 0.05
BEYOND = 5.0  # largest |action| that is told apart
JITTER, MEMORY = 0.1, 0.9  # of the first episodes' random torques: share of the limits, correlation of two periods
CLIP = 10.0  # largest |normalised observation|


class TrainingLanes(VecEnvWrapper):
    """Pliant's lanes with shaped rewards. After `reset` they are anywhere in their episodes, moving a little."""

    def __init__(
        self, scene: TrainableScene, num_envs: int, *, spread: float, bounded: bool, seed: int, threads: int
    ) -> None:
        near, far = dict(scene.start), dict(scene.goal)
        distance = max((abs(far[name] - near[name]) for name in near if name in far), default=0.0)
        wide: Any = dataclasses.replace(cast(Any, scene), start_spread=max(scene.start_spread, spread * distance))
        super().__init__(wide.sb3_env(num_envs, randomise=True, threads=threads))
        self.scene = scene
        rate = float(scene.stage_cost(*scene.initial, scene.plant.measure(*scene.initial)))
        self.unit = 0.5 * rate if rate > 0 else scene.early_end_rate
        self._knee = KNEE * scene.dt * rate / self.unit if rate > 0 else np.inf
        self._seed = seed
        self._excess: np.ndarray | float = 0.0
        self.seen = self.last = np.zeros((0, len(scene.observe)))  # observations of the last `reset`
        if not bounded:
            self.action_space = spaces.Box(-BEYOND, BEYOND, self.action_space.shape, np.float32)

    def reset(self) -> np.ndarray:
        """Start, then one episode's time of small random torques, each lane starting again at its own moment."""
        rng = np.random.default_rng(self._seed)
        self.venv.seed(self._seed)
        obs = np.asarray(self.venv.reset())
        vector: Any = self.venv.vector  # type: ignore[attr-defined]
        phase = rng.integers(0, self.scene.steps, self.num_envs)
        torque = np.zeros((self.num_envs, self.scene.plant.nu), dtype=np.float32)
        seen = []
        for k in range(self.scene.steps):
            obs = np.asarray(self.venv.step(JITTER * torque)[0])
            torque = MEMORY * torque + np.sqrt(1 - MEMORY**2) * rng.standard_normal(torque.shape, np.float32)
            seen.append(obs)
            mask = phase == k
            if mask.any():
                obs, _ = vector.reset(options={"reset_mask": mask})
        self.seen, self.last = np.concatenate(seen), obs
        return obs

    def step_async(self, actions: np.ndarray) -> None:
        self._excess = EXCESS * np.square(np.maximum(np.abs(actions) - 1, 0)).sum(axis=1)
        self.venv.step_async(np.clip(actions, -1, 1))

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        obs, rewards, dones, infos = self.venv.step_wait()
        cost, knee = -rewards / self.unit, self._knee
        high = cost > knee
        if high.any():
            cost[high] = knee * (1 + np.log(cost[high] / knee))
        for i in np.flatnonzero(dones):
            if not infos[i]["TimeLimit.truncated"]:
                cost[i] = EARLY_END
        return obs, -(cost + self._excess).astype(np.float32), dones, infos


def normalised(lanes: TrainingLanes) -> VecNormalize:
    """The lanes with observations over their spread, which keeps being learned; rewards as they are."""
    return VecNormalize(lanes, norm_obs=True, norm_reward=False, clip_obs=CLIP)

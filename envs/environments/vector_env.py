"""Many environments of one scene at once: dynamics, observation, cost and limits of the whole batch in one kernel."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from pliant.envs import scenes
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.control_period import check_substep
from pliant.envs.simulation.episode_start import begin, early_end_cost, first_observations
from pliant.plants.core import parameters
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.native.batch_kernels import FEW, as_dtype
from pliant.plants.native.thread_pool import available

Array = np.ndarray


class PlantVectorEnv(OwnsArrays, VectorEnv[Array, Array, Array]):
    """`num_envs` lanes of a scene; see PlantEnv for action, observation, reward and the ends of an episode.

    | what         | is                                                                        | shape            |
    |--------------|---------------------------------------------------------------------------|------------------|
    | actions      | inputs over scene.limits, clipped to [-1, 1]                              | (num_envs, nu)   |
    | observations | scene.observe less their values at the goal, `dtype`                      | (num_envs, no)   |
    | rewards      | -dt * stage cost, and the charge for an early end                         | (num_envs,)      |

    autoreset_mode  "NextStep" (default): the step after an episode's end ignores its action and returns the new start,
                    with reward 0. "SameStep": the new start comes at once, and infos["final_obs"] holds the last
                    observation. "Disabled": reset(options={"reset_mask": mask}) starts lanes again
    randomise       draws start, parameters and disturbances of every episode of every lane from `np_random`
    dtype           float64, or float32 for observations and physics in single precision
    threads         None: all processors for large batches
    infos           "diverged" (num_envs,) bool with its mask "_diverged", where an episode ended in this step;
                    "validity" (num_envs,) with its mask "_validity", where a lane lies outside a range of the plant's
                    `validity`: the largest value over its limit, above 1
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(
        self,
        scene: str | Scene,
        num_envs: int = 1,
        *,
        randomise: bool = False,
        dtype: type | str = np.float64,
        threads: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
    ) -> None:
        self.scene = scene = scenes.get(scene) if isinstance(scene, str) else scene
        parameters.require_count("PlantVectorEnv", "num_envs", num_envs, 1, 10_000_000)
        parameters.require_choice("PlantVectorEnv", "render_mode", render_mode, (None,))
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode}
        self.num_envs, self.randomise, self.render_mode = num_envs, bool(randomise), render_mode
        self._dtype = as_dtype(dtype)
        check_substep(scene, self.randomise)
        if threads is None:
            threads = available() if num_envs >= FEW else 1
        self._step = ControlStep(scene, num_envs, self._dtype, threads)
        self.single_action_space = spaces.Box(-1.0, 1.0, (scene.plant.nu,), np.float32)
        self.single_observation_space = spaces.Box(-np.inf, np.inf, (len(scene.observe),), self._dtype.type)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        x, p = scene.initial[0], scene.varied_plant.nominal_parameters
        self._nominal_start = x, first_observations(scene, x[None], p[None])[0]
        widths = (scene.plant.nx, len(scene.observe), scene.plant.nw, len(p))
        self._none_drawn = [np.zeros((0, n)) for n in widths]
        self._drawn = self._none_drawn
        self._done = np.zeros(num_envs, dtype=np.int64)
        self._over = np.ones(num_envs, dtype=bool)
        self._obs = np.zeros((num_envs, len(scene.observe)), dtype=self._dtype)

    @property
    def states(self) -> Array:
        """States (num_envs, nx), a copy."""
        return np.ascontiguousarray(self._step.x.T)

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self._step.native

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start all lanes, or those of options["reset_mask"] (num_envs,) bool. One seed serves all lanes."""
        if seed is not None and not isinstance(seed, (int, np.integer)):
            raise ValueError(f"PlantVectorEnv.reset: seed = {seed!r} must be one integer: it seeds every lane")
        if seed is not None:
            self._np_random, self._np_random_seed = gymnasium.utils.seeding.np_random(int(seed))
            self._drawn = self._none_drawn
        options = options or {}
        for key in options:
            parameters.require_choice("PlantVectorEnv.reset", "options", key, ("reset_mask",))
        mask = np.asarray(options.get("reset_mask", np.ones(self.num_envs, dtype=bool)))
        if mask.shape != (self.num_envs,) or mask.dtype != bool:
            raise ValueError(
                f"PlantVectorEnv.reset: reset_mask of {mask.dtype}{mask.shape} must be ({self.num_envs},) bool"
            )
        self._obs = self._obs.copy()
        self._start(np.flatnonzero(mask))
        return self._obs.copy(), {}

    def _start(self, lanes: Array) -> None:
        """New episodes in the lanes (k,)."""
        step = self._step
        if self.randomise:
            x, obs, w, p = self._draw(len(lanes))
            step.x[:, lanes], step.w[:, lanes], step.p[:, lanes] = x.T, w.T, p.T
        else:
            x, obs = self._nominal_start
            step.x[:, lanes] = x[:, None]
        self._obs[lanes] = obs
        self._done[lanes] = 0
        self._over[lanes] = False

    def _draw(self, n: int) -> list[Array]:
        """The next n episodes (x, obs, w, p): drawn as many at a time as there are lanes, which costs less each."""
        if n > len(self._drawn[0]):
            more = begin(self.scene, self.np_random, self.num_envs)
            self._drawn = [np.concatenate(pair) for pair in zip(self._drawn, more)]
        taken = [a[:n] for a in self._drawn]
        self._drawn = [a[n:] for a in self._drawn]
        return taken

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Hold `actions` (num_envs, nu) for one control period in every lane."""
        actions = np.asarray(actions)
        if actions.shape != self.action_space.shape:
            raise ValueError(
                f"PlantVectorEnv.step: actions have shape {actions.shape}, must be {self.action_space.shape}"
            )
        step, scene = self._step, self.scene
        step.action[:] = actions.T
        if not np.isfinite(step.action.sum()):
            k = int(np.argmin(np.isfinite(actions).all(axis=1)))
            raise ValueError(f"PlantVectorEnv.step: actions[{k}] = {actions[k]} must be finite numbers in [-1, 1]")
        waiting = np.flatnonzero(self._over)
        if len(waiting) and self.autoreset_mode == AutoresetMode.DISABLED:
            raise gymnasium.error.ResetNeeded(
                f"PlantVectorEnv.step: lane {waiting[0]} is over; reset it with options={{'reset_mask': ...}}"
            )
        step.begin(self._done)
        diverged, outside = step.run()
        self._done += 1
        cost = step.cost.astype(float)
        terminated = diverged | outside
        last, self._obs = self._obs, np.ascontiguousarray(step.obs.T)
        if len(waiting):  # these lanes start again instead
            terminated[waiting] = diverged[waiting] = False
            self._done[waiting] = 0
        ended = np.flatnonzero(terminated)
        if len(ended):
            self._obs[diverged] = last[diverged]
            cost[ended] += early_end_cost(scene, self._done[ended], cost[ended])
        truncated = (self._done >= scene.steps) & ~terminated
        over = terminated | truncated
        infos: dict[str, Any] = {}
        if over.any():
            infos = {"diverged": diverged, "_diverged": over}
        invalid = step.reach > 1.0
        if np.count_nonzero(invalid):
            invalid &= ~diverged
            invalid[waiting] = False
            if invalid.any():
                infos["validity"], infos["_validity"] = np.where(invalid, step.reach, 0.0), invalid
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            lanes = np.flatnonzero(over)
            if len(lanes):
                infos["final_obs"], infos["_final_obs"] = self._obs.copy(), over
                self._start(lanes)
        else:
            if len(waiting):
                cost[waiting] = 0.0
                self._start(waiting)
            self._over = over
        return self._obs.copy(), -cost, terminated, truncated, infos

"""The native vector environment as a Stable-Baselines3 VecEnv."""

from __future__ import annotations

import operator
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from pliant.envs.scenes.scene import Scene
from pliant.envs.tasks import TaskKeywords
from pliant.envs.tasks.infos import of_lanes
from pliant.plants.core.argument_gates import shown
from pliant.plants.core.signals import OwnsArrays

from . import arguments
from .vector_env import PlantVectorEnv

Indices = int | Iterable[int] | None


class PlantVecEnv(OwnsArrays, VecEnv):
    """`num_envs` lanes of a scene for Stable-Baselines3: episodes restart in the step that ends them.

    Keywords are PlantVectorEnv's (`randomise`, `dtype`, `threads`, `render_mode`, .., those of `Task`); observations
    default to float32, what its networks take. Where an episode ended, infos[i] holds "terminal_observation",
    "TimeLimit.truncated", "diverged", "cost" and "early_end_cost" of the last period and the "parameters" it was played
    with, where it is drawn also the "fidelity", and where a range of the plant's `validity` is left its largest value
    over its limit as "validity"; every other infos[i] is an empty dictionary of its lane's own. "reward_terms" and
    "cost_constraint" are told of every period where the task asks for them.

    `seed(s)` seeds lane i with s + i, which then plays the episodes of PlantEnv.reset(seed=s + i); `set_options` takes
    what PlantEnv.reset does, for all lanes or a list with one dictionary a lane. Both serve the next `reset`. What
    cannot be done to one lane alone (`set_attr("randomise", True, indices=0)`) is refused.
    """

    def __init__(
        self,
        scene: str | Scene,
        num_envs: int,
        *,
        randomise: bool = False,
        dtype: type | str = np.float32,
        threads: int | None = None,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        **task: Unpack[TaskKeywords],
    ) -> None:
        self.vector = PlantVectorEnv(
            scene,
            num_envs,
            randomise=randomise,
            dtype=dtype,
            threads=threads,
            autoreset_mode=AutoresetMode.SAME_STEP,
            render_mode=render_mode,
            max_episode_steps=max_episode_steps,
            **task,
        )
        self._actions: np.ndarray | None = None
        self._blank: list[dict[str, Any]] = [{} for _ in range(self.vector.num_envs)]  # new ones cost as much as a step
        super().__init__(self.vector.num_envs, self.vector.single_observation_space, self.vector.single_action_space)

    @property
    def reset_infos(self) -> list[dict[str, Any]]:
        """The "parameters" of the episode that each lane plays, its "fidelity" where that is drawn; empty before the
        first reset."""
        if not self.vector.begun:
            return [{} for _ in range(self.num_envs)]
        lanes = np.arange(self.num_envs)
        return of_lanes(self.vector.told_of(lanes), lanes)

    @reset_infos.setter
    def reset_infos(self, value: list[dict[str, Any]]) -> None:
        """What the base class begins with: empty ones, as here."""

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed lane i with seed + i, None at random, for the next `reset`; returns the seeds."""
        return super().seed(arguments.require_seed("PlantVecEnv.seed", seed))

    def set_options(self, options: list[dict[str, Any]] | dict[str, Any] | None = None) -> None:
        """Options of the next `reset`: "state" (nx,) and "parameters" by name, for all lanes or for each.

        ValueError for others, and for values out of range.
        """
        owner, n = "PlantVecEnv.set_options", self.num_envs
        if options is None or isinstance(options, Mapping):
            self._options = [self._start(owner, options)] * n  # only read from here on
        elif isinstance(options, (list, tuple)) and len(options) == n:
            self._options = [self._start(owner, own) for own in options]
        else:
            raise ValueError(f"{owner}: options = {shown(options)} must be a dictionary, or a list of {n} of them")

    def _start(self, owner: str, options: Any) -> dict[str, Any]:
        mixture = self.vector._mixture
        own = arguments.require_options(owner, options, arguments.known(mixture))
        return arguments.require_start(owner, self.vector.scene, own, mixture)

    def reset(self) -> np.ndarray:
        """New episodes in all lanes, with the seeds and options set since the last reset."""
        given = self._options if any(self._options) else None
        obs, _ = self.vector.restart(np.arange(self.num_envs), list(self._seeds), given)
        self._reset_seeds()
        self._reset_options()
        self._actions = None
        return obs

    def step_async(self, actions: np.ndarray) -> None:
        """Take actions (num_envs, nu) for the next `step_wait`, as they are now."""
        self._actions = np.array(actions)

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Observations (num_envs, no), rewards (num_envs,) float32, dones (num_envs,) and infos."""
        if self._actions is None:
            raise gymnasium.error.ResetNeeded("PlantVecEnv.step_wait: no actions wait; call reset, then step_async")
        actions, self._actions = self._actions, None
        obs, reward, terminated, truncated, valid, ended, _ = self.vector.advance(actions)
        if any(self._blank):  # written to by who got them: theirs
            self._blank = [{} if told else told for told in self._blank]
        infos = self._blank.copy()
        if ended is not None:
            names, lanes = self.vector.scene.varied_plant.varied, ended.lanes.tolist()
            columns = (ended.cost, ended.early_end_cost, ended.diverged, truncated[ended.lanes], ended.parameters)
            for i, last, cost_i, early, diverged, late, p in zip(lanes, ended.obs, *(a.tolist() for a in columns)):
                infos[i] = {
                    "terminal_observation": last,
                    "TimeLimit.truncated": late,
                    "diverged": diverged,
                    "cost": cost_i,
                    "early_end_cost": early,
                    "parameters": dict(zip(names, p)),
                }
            for i, label in zip(lanes, () if ended.fidelity is None else ended.fidelity.tolist()):
                infos[i]["fidelity"] = label
        if "validity" in valid:
            for i in valid["_validity"].nonzero()[0].tolist():
                infos[i] = {**infos[i], "validity": float(valid["validity"][i])}
        for key in ("cost_constraint", "reward_terms"):
            if key in valid:
                told = of_lanes({key: valid[key], f"_{key}": valid[f"_{key}"]}, np.arange(self.num_envs))
                infos = [{**own, **more} for own, more in zip(infos, told)]
        return obs, reward.astype(np.float32), terminated | truncated, infos

    def close(self) -> None:
        """Nothing is held open; may be called again."""
        self.vector.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """A picture (height, width, 3) uint8 of every lane, as PlantVectorEnv draws them; None for every lane, with a
        warning, unless the environment was made with render_mode="rgb_array".
        """
        if self.render_mode is None:
            warnings.warn('PlantVecEnv.get_images: make the environment with render_mode="rgb_array"', stacklevel=2)
            return [None] * self.num_envs
        return list(self.vector.render() or ())

    def _lanes(self, indices: Indices) -> list[int]:
        """The lanes named, negative ones counted from the end; IndexError where there is none."""
        if indices is None:
            return list(range(self.num_envs))
        named = [indices] if isinstance(indices, (int, np.integer)) else list(indices)
        lanes = [operator.index(i) for i in named]
        for lane in lanes:
            if not -self.num_envs <= lane < self.num_envs:
                raise IndexError(f"PlantVecEnv: indices = {indices!r} must name lanes from 0 to {self.num_envs - 1}")
        return [lane % self.num_envs for lane in lanes]

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """An attribute of each lane named: its own ("state", "time", what was set there) or the batch's."""
        lanes = self._lanes(indices)
        if attr_name in ("_seeds", "_options", "vector"):
            return [getattr(self, attr_name)] * len(lanes)
        return self.vector.lane_attr(attr_name, lanes)

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Set an attribute of the lanes named; ValueError where all share it and not all are, or it is fixed."""
        lanes = self._lanes(indices)
        self.vector.set_lane_attr(attr_name, [value] * len(lanes), lanes)

    def env_method(self, method_name: str, *args: Any, indices: Indices = None, **kwargs: Any) -> list[Any]:
        """Call a method in the lanes named: "reset" starts those alone; ValueError where it acts on all lanes."""
        return self.vector.call_lanes(method_name, self._lanes(indices), *args, **kwargs)

    def env_is_wrapped(self, wrapper_class: type[gymnasium.Wrapper], indices: Indices = None) -> list[bool]:
        """False: no lane is an environment that could be wrapped."""
        return [False] * len(self._lanes(indices))

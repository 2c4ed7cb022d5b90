"""The native vector environment as a Stable-Baselines3 VecEnv."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.signals import OwnsArrays

from .vector_env import PlantVectorEnv


class PlantVecEnv(OwnsArrays, VecEnv):
    """`num_envs` lanes of a scene for Stable-Baselines3: episodes restart in the step that ends them.

    Keywords are PlantVectorEnv's (`randomise`, `dtype`, `threads`); observations default to float32, what its networks
    take. Where an episode ended, infos[i] holds "terminal_observation", "TimeLimit.truncated" and "diverged", and
    where a range of the plant's `validity` is left its largest value over its limit as "validity"; every other infos[i]
    is an empty dictionary of its lane's own.
    """

    def __init__(
        self,
        scene: str | Scene,
        num_envs: int,
        *,
        randomise: bool = False,
        dtype: type | str = np.float32,
        threads: int | None = None,
    ) -> None:
        self.vector = PlantVectorEnv(
            scene,
            num_envs,
            randomise=randomise,
            dtype=dtype,
            threads=threads,
            autoreset_mode=AutoresetMode.SAME_STEP,
        )
        self.render_mode = None
        self._infos: list[dict[str, Any]] = [{} for _ in range(num_envs)]
        self._actions = np.zeros((num_envs, self.vector.scene.plant.nu), dtype=np.float32)
        super().__init__(num_envs, self.vector.single_observation_space, self.vector.single_action_space)

    def reset(self) -> np.ndarray:
        """New episodes in all lanes, from the seed of the last `seed` call if there was one since the last reset."""
        obs, _ = self.vector.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._reset_options()
        return obs

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        obs, rewards, terminated, truncated, ended = self.vector.step(self._actions)
        dones = terminated | truncated
        infos = self._infos.copy()
        for i in np.flatnonzero(dones):
            infos[i] = {
                "terminal_observation": ended["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i]),
                "diverged": bool(ended["diverged"][i]),
            }
        for i in np.flatnonzero(ended.get("_validity", ())):
            infos[i] = {**infos[i], "validity": float(ended["validity"][i])}
        return obs, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        self.vector.close()

    def _lanes(self, indices: int | Iterable[int] | None) -> Sequence[int]:
        return list(self._get_indices(indices))

    def get_attr(self, attr_name: str, indices: int | Iterable[int] | None = None) -> list[Any]:
        """An attribute of this environment, or of the vector environment, once a lane."""
        owner = self if attr_name in self.__dict__ else self.vector
        return [getattr(owner, attr_name)] * len(self._lanes(indices))

    def set_attr(self, attr_name: str, value: Any, indices: int | Iterable[int] | None = None) -> None:
        """Set an attribute of the vector environment; all lanes share it, so all must be named."""
        if len(self._lanes(indices)) != self.num_envs:
            raise ValueError(f"set_attr({attr_name!r}): indices = {indices} must name all lanes, which share it")
        setattr(self.vector, attr_name, value)

    def env_method(
        self, method_name: str, *args: Any, indices: int | Iterable[int] | None = None, **kwargs: Any
    ) -> list[Any]:
        """Call a method of the vector environment once; its result is repeated for each lane named."""
        return [getattr(self.vector, method_name)(*args, **kwargs)] * len(self._lanes(indices))

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper], indices: int | Iterable[int] | None = None
    ) -> list[bool]:
        return [False] * len(self._lanes(indices))

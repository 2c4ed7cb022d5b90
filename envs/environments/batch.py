"""What a batch of lanes holds and shows between two calls of `reset` and `step`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.control_period import check_substep
from pliant.envs.simulation.episode_start import first_observations, initial_states
from pliant.envs.simulation.episode_supply import EpisodeSupply
from pliant.plants.core.argument_gates import require_flag
from pliant.plants.core.signals import OwnsArrays

from .lanes import Lanes
from .specification import Specified

Array = np.ndarray


class Batch(Specified, OwnsArrays, Lanes):
    """Lanes of one scene: their states and times, how they are drawn, how they travel to another process."""

    scene: Scene
    _step: ControlStep
    _supply: EpisodeSupply
    _done: Array  # control periods (num_envs,) played of each lane's episode
    _names: tuple[str, ...]  # of the randomised parameters
    begun: bool  # whether every lane has been started

    @property
    def states(self) -> Array:
        """States (num_envs, nx), a copy. ResetNeeded before the first reset."""
        self._require_begun("states")
        return self._step.x.T.copy()

    @property
    def times(self) -> Array:
        """Times (num_envs,) since the start of each lane's episode [s]. ResetNeeded before the first reset."""
        self._require_begun("times")
        return self._done * self.scene.dt

    @property
    def randomise(self) -> bool:
        """Whether episodes are drawn; what is set holds from the next start of a lane."""
        return self._randomise

    @randomise.setter
    def randomise(self, value: bool) -> None:
        value = require_flag("PlantVectorEnv.randomise", value)
        check_substep(self.scene, value)
        self._randomise = value

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self._step.native

    def generator_of(self, lane: int) -> np.random.Generator:
        """The random numbers that a lane draws its episodes from."""
        return self._supply.generator(lane) or self.np_random

    def render(self) -> None:
        """None, with a warning: lanes are not drawn, PlantEnv is."""
        gymnasium.logger.warn("PlantVectorEnv.render: lanes are not drawn; PlantEnv draws one")

    def _require_begun(self, asked: str) -> None:
        if not self.begun:
            raise gymnasium.error.ResetNeeded(f"PlantVectorEnv.{asked}: no episode has begun; call reset first")

    def parameters_of(self, lanes: Array) -> Array:
        """The randomised parameters (k, np) of the episodes that the lanes (k,) play."""
        return self._step.p[:, lanes].T.astype(float)

    def _given(self, given: list[dict[str, Any]], x: Array, obs: Array, p: Array) -> tuple[Array, Array, Array]:
        """Starts (x, obs, p), k rows each, with what the options of each give in place of what was drawn."""
        for k, own in enumerate(given):
            for name, value in own.get("parameters", {}).items():
                p[k, self._names.index(name)] = value
            if "state" in own:
                x[k] = own["state"]
        other = [k for k, own in enumerate(given) if own.get("parameters") and "state" not in own]
        if other and self.scene.start_at_rest:
            held = x[other][:, self.scene.positions(name for name, _ in self.scene.start)]
            x[other] = initial_states(self.scene, held, p[other])
        changed = [k for k, own in enumerate(given) if own]
        if changed:
            obs[changed] = first_observations(self.scene, x[changed], p[changed])
        return x, obs, p

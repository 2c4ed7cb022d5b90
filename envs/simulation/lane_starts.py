"""How lanes begin episodes: from the scene's own start, from what is drawn, from what is given in place of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.signals import OwnsArrays

from .episode_start import first_observations, initial_states
from .episode_supply import EpisodeSupply

Array = np.ndarray
Given = Sequence[dict[str, Any]]  # of each lane: "state" (nx,), "parameters" by name


class LaneStarts(OwnsArrays):
    """Starts (x, obs, w, p) of lanes that all play the scene's own plant."""

    def __init__(self, scene: Scene, lanes: int) -> None:
        self.scene = scene
        self.names, nominal = scene.varied_plant.varied, scene.varied_plant.nominal_parameters
        self._supply = EpisodeSupply(scene, lanes)
        x = scene.initial[0]
        self._own = x, first_observations(scene, x[None], nominal[None])[0], np.zeros(scene.plant.nw), nominal

    def seed(self, lanes: Array, seeds: Sequence[int]) -> None:
        """From now on the episodes of the lanes (k,) come from streams of these seeds."""
        self._supply.seed(lanes, seeds)

    def generator(self, lane: int) -> np.random.Generator | None:
        """The lane's own stream, if it has one."""
        return self._supply.generator(lane)

    def begin(
        self, lanes: Array, randomise: bool, given: Given | None, shared: Callable[[], np.random.Generator]
    ) -> tuple[Array, Array, Array, Array]:
        """(x, obs, w, p) of new episodes in the lanes (k,): k rows each, or one row that holds for all of them."""
        if randomise:
            x, obs, w, p = self._supply.take(lanes, shared)
        else:
            x, obs, w, p = (a[None] for a in self._own)
        if given is not None:
            x, obs, p = self._as_given(given, *(np.tile(a, (len(lanes) // len(a), 1)) for a in (x, obs, p)))
        return x, obs, w, p

    def _as_given(self, given: Given, x: Array, obs: Array, p: Array) -> tuple[Array, Array, Array]:
        """Starts (x, obs, p), k rows each, with what the options of each give in place of what was drawn."""
        put_parameters(self.names, given, p)
        for k, own in enumerate(given):
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


def put_parameters(names: Sequence[str], given: Given, p: Array) -> None:
    """Write the parameters that are given, by name, into p (k, np)."""
    for k, own in enumerate(given):
        for name, value in own.get("parameters", {}).items():
            p[k, names.index(name)] = value

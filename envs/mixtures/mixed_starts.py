"""How lanes of a mixture begin episodes: coordinates and parameters drawn alike, at rest each in its own model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import cast

import numpy as np

from pliant.envs.simulation.episode_start import first_observations, initial_states
from pliant.envs.simulation.episode_supply import EpisodeSupply
from pliant.envs.simulation.lane_starts import Given, LaneStarts, put_parameters

from .mixture import Mixture

Array = np.ndarray


class MixedStarts(LaneStarts):
    """Starts as `LaneStarts` has them; rows of x (k, nx of the widest model), zero beyond a lane's own states.

    What is observed is less the goal's values in the scene's own plant, as in all lanes.
    """

    def __init__(self, mixture: Mixture) -> None:
        scene = mixture.scene
        super().__init__(scene, mixture.lanes)
        self.mixture = mixture
        self._supply = EpisodeSupply(scene, mixture.lanes, settled=False)
        self._held = np.array([value for _, value in scene.start])

    def seed(self, lanes: Array, seeds: Sequence[int]) -> None:
        super().seed(lanes, seeds)
        self.mixture.seed(lanes.tolist(), seeds)

    def begin(
        self, lanes: Array, randomise: bool, given: Given | None, shared: Callable[[], np.random.Generator]
    ) -> tuple[Array, Array, Array, Array]:
        mixture, scene, k = self.mixture, self.scene, len(lanes)
        unseeded = mixture.unseeded(lanes)
        if unseeded:
            mixture.seed(unseeded, shared().integers(2**62, size=len(unseeded)).tolist())
        mixture.draw(lanes)
        if randomise:
            held, w, p = self._supply.take(lanes, shared)
        else:
            held, w, p = (np.tile(a, (k, 1)) for a in (self._held, *self._own[2:]))
        given = [{}] * k if given is None else given
        put_parameters(self.names, given, p)
        for lane, own in zip(lanes.tolist(), given):
            mixture.rung[lane] = own.get("fidelity", mixture.rung[lane])
        drawn = randomise or any("parameters" in own for own in given)
        x, obs = np.zeros((k, mixture.widths.max())), np.zeros((k, len(scene.observe)))
        for g, rows in mixture.groups(lanes):
            rung = mixture.scenes[g]
            states = initial_states(rung, held[rows], p[rows]) if drawn else np.tile(rung.initial[0], (len(rows), 1))
            x[rows, : states.shape[1]] = states
            obs[rows] = first_observations(rung, states, p[rows], scene)
        return x, obs, cast(Array, w), p

"""What a batch of lanes holds and shows between two calls of `reset` and `step`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import gymnasium
import numpy as np

from pliant.envs.rendering import Renderer, renderer
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.control_period import check_substep
from pliant.envs.simulation.cost_terms import cost_terms, term_names
from pliant.envs.simulation.episode_start import first_observations, initial_states
from pliant.envs.simulation.episode_supply import EpisodeSupply
from pliant.envs.tasks import Channel
from pliant.envs.tasks.infos import of_parameters, of_terms
from pliant.plants.core.argument_gates import require_flag
from pliant.plants.core.signals import OwnsArrays

from .lanes import Lanes
from .specification import Specified

Array = np.ndarray
MOST_PICTURES = 64


class Batch(Specified, OwnsArrays, Lanes):
    """Lanes of one scene: their states and times, how they are drawn, how they travel to another process."""

    scene: Scene
    _step: ControlStep
    _supply: EpisodeSupply
    _done: Array  # control periods (num_envs,) played of each lane's episode
    _names: tuple[str, ...]  # of the randomised parameters
    _channel: Channel | None
    _obs: Array  # (num_envs, no) the signals, as the kernel shows them
    _seen: Array  # (num_envs, ..) what is read of them: the same array where all passes as it is
    _over: Array  # (num_envs,) whether a lane waits for its next episode
    _first: Array  # (no,) the signals at the scene's own start
    _nominal: Array  # (np,) the plant's own parameters
    _randomise: bool
    _varied: bool  # whether some lane has had other parameters than those
    _pictures: list[Renderer]  # one a lane, once asked for
    _total: Array  # what each lane's episode has cost, where pictures are drawn
    render_mode: str | None
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

    def render(self) -> tuple[Array, ...] | None:
        """A picture (height, width, 3) uint8 of every lane, as PlantEnv draws it; at most MOST_PICTURES of them.

        None, with a warning, unless the environment was made with render_mode="rgb_array".
        """
        if self.render_mode is None:
            gymnasium.logger.warn('PlantVectorEnv.render: make the environment with render_mode="rgb_array"')
            return None
        self._require_begun("render")
        if self.num_envs > MOST_PICTURES:
            raise ValueError(f"render: num_envs = {self.num_envs} must be at most {MOST_PICTURES}, a picture each")
        if not self._pictures:
            self._pictures = [renderer(self.scene) for _ in range(self.num_envs)]
        step = self._step
        x, u = step.x.T.astype(float), step.action.T.astype(float)
        lanes = zip(self._pictures, x, u, self.times.tolist(), self._total.tolist())
        return tuple(cast(Array, drawn.draw(*lane)) for drawn, *lane in lanes)

    def _terms(self, waiting: Array) -> dict[str, Any]:
        """What each term of the period that begins adds to the rewards of lanes that do not wait."""
        step, playing = self._step, np.setdiff1d(np.arange(self.num_envs), waiting)
        u = np.clip(step.action.T.astype(float), -1.0, 1.0) * self.scene.limits
        x, ref, w, p = (a.T.astype(float) for a in (step.x, step.ref, step.w, step.p))
        names = term_names(self.scene)  # none where nothing is weighed
        found = cost_terms(self.scene)(x, u, ref, w, p)[0] if names else np.zeros((len(x), 0))
        return of_terms(self.num_envs, playing, names, found[playing])

    def _require_begun(self, asked: str) -> None:
        if not self.begun:
            raise gymnasium.error.ResetNeeded(f"PlantVectorEnv.{asked}: no episode has begun; call reset first")

    def parameters_of(self, lanes: Array) -> Array:
        """The randomised parameters (k, np) of the episodes that the lanes (k,) play."""
        return self._step.p[:, lanes].T.astype(float)

    def restart(
        self, lanes: Array, seeds: Sequence[int | None], given: list[dict[str, Any]] | None
    ) -> tuple[Array, dict[str, Any]]:
        """`reset` with its arguments checked: lanes (k,), seeds and options of every lane."""
        seeded = [int(lane) for lane in lanes if seeds[lane] is not None]
        if seeded:
            own = [cast(int, seeds[lane]) for lane in seeded]
            self._supply.seed(np.array(seeded), own)
            if self._channel is not None:
                self._channel.seed(seeded, own)
        self._start(lanes, given)
        self.begun = True
        return self._seen.copy(), of_parameters(self.num_envs, lanes, self._names, self.parameters_of(lanes))

    def _start(self, lanes: Array, given: list[dict[str, Any]] | None = None) -> None:
        """New episodes in the lanes (k,)."""
        step, k = self._step, len(lanes)
        if self._randomise:
            x, obs, w, p = self._supply.take(lanes, lambda: self.np_random)
        else:
            x, obs, w, p = (a[None] for a in (self.scene.initial[0], self._first, np.zeros(len(step.w)), self._nominal))
        if given is not None:
            x, obs, p = self._given(
                [given[lane] for lane in lanes], *(np.tile(a, (k // len(a), 1)) for a in (x, obs, p))
            )
        step.x[:, lanes] = x.T
        if self._randomise or given is not None or self._varied:
            step.w[:, lanes], step.p[:, lanes], self._varied = w.T, p.T, True
        self._obs[lanes] = obs
        self._done[lanes] = 0
        self._over[lanes] = False
        if self._channel is None:
            self._seen = self._obs
        else:
            self._first_seen(self._channel, lanes)
        self._total[lanes] = 0.0
        for lane in lanes.tolist() if self._pictures else ():
            self._pictures[lane].clear()

    def _first_seen(self, channel: Channel, lanes: Array) -> None:
        """What is read first of episodes in the lanes (k,); those without a seed get one from the shared stream."""
        unseeded = channel.unseeded(lanes)
        if unseeded:
            channel.seed(unseeded, self.np_random.integers(2**62, size=len(unseeded)).tolist())
        shown, references = channel.begin(lanes, self._obs[lanes].astype(float))
        self._seen[lanes] = shown
        if references is not None:
            self._step.aim(lanes, references)

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

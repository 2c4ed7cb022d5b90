"""What a batch of lanes holds and shows between two calls of `reset` and `step`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import gymnasium
import numpy as np

from pliant.envs.mixtures import Mixture
from pliant.envs.rendering import Renderer, renderer
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.control_period import check_substep
from pliant.envs.simulation.cost_terms import cost_terms, term_names
from pliant.envs.simulation.lane_starts import LaneStarts
from pliant.envs.tasks import Channel
from pliant.envs.tasks.infos import masked, of_parameters, of_terms
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
    _starts: LaneStarts
    _mixture: Mixture | None  # where lanes play different models
    _done: Array  # control periods (num_envs,) played of each lane's episode
    _names: tuple[str, ...]  # of the randomised parameters
    _channel: Channel | None
    _obs: Array  # (num_envs, no) the signals, as the kernel shows them
    _seen: Array  # (num_envs, ..) what is read of them: the same array where all passes as it is
    _over: Array  # (num_envs,) whether a lane waits for its next episode
    _randomise: bool
    _varied: bool  # whether some lane has had other parameters than the plant's own
    _pictures: list[Renderer]  # one a lane, once asked for
    _total: Array  # what each lane's episode has cost, where pictures are drawn
    render_mode: str | None
    begun: bool  # whether every lane has been started

    @property
    def states(self) -> Array:
        """States (num_envs, nx), a copy. ResetNeeded before the first reset.

        Where fidelities are drawn, nx is that of the widest model, and NaN stands beyond a lane's own states.
        """
        self._require_begun("states")
        found = self._step.x.T.copy()
        if self._mixture is not None:
            found[np.arange(found.shape[1]) >= self._widths(np.arange(self.num_envs))[:, None]] = np.nan
        return found

    @property
    def fidelities(self) -> Array:
        """The label (num_envs,) of the model that each lane plays. ResetNeeded before the first reset."""
        self._require_begun("fidelities")
        if self._mixture is None:
            return np.full(self.num_envs, self.scene.plant.label)
        return self._mixture.labels[self._mixture.rung]

    def _played(self, lane: int) -> Scene:
        """The scene on the model that a lane plays."""
        return self.scene if self._mixture is None else self._mixture.scenes[self._mixture.rung[lane]]

    def _widths(self, lanes: Array) -> Array:
        """How many states the lanes (k,) have."""
        return np.array([self._played(lane).plant.nx for lane in lanes.tolist()])

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
        return self._starts.generator(lane) or self.np_random

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
            self._pictures = [renderer(self._played(lane)) for lane in range(self.num_envs)]
        step, widths = self._step, self._widths(np.arange(self.num_envs))
        x, u = step.x.T.astype(float), step.action.T.astype(float)
        own = [row[:width] for row, width in zip(x, widths)]
        lanes = zip(self._pictures, own, u, self.times.tolist(), self._total.tolist())
        return tuple(cast(Array, drawn.draw(*lane)) for drawn, *lane in lanes)

    def _terms(self, waiting: Array) -> dict[str, Any]:
        """What each term of the period that begins adds to the rewards of lanes that do not wait."""
        step, playing = self._step, np.setdiff1d(np.arange(self.num_envs), waiting)
        u = np.clip(step.action.T.astype(float), -1.0, 1.0) * self.scene.limits
        x, ref, w, p = (a.T.astype(float) for a in (step.x, step.ref, step.w, step.p))
        names = term_names(self.scene)  # none where nothing is weighed
        found = np.zeros((len(x), len(names)))
        every = np.arange(self.num_envs)
        for g, rows in [(0, every)] if self._mixture is None else self._mixture.groups(every):
            scene = self.scene if self._mixture is None else self._mixture.scenes[g]
            if names:
                found[rows] = cost_terms(scene)(x[rows, : scene.plant.nx], *(a[rows] for a in (u, ref, w, p)))[0]
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
            self._starts.seed(np.array(seeded), own)
            if self._channel is not None:
                self._channel.seed(seeded, own)
        self._start(lanes, given)
        self.begun = True
        return self._seen.copy(), self.told_of(lanes)

    def told_of(self, lanes: Array) -> dict[str, Any]:
        """What is told of episodes that begin or end in the lanes (k,): parameters, the fidelity where it is drawn."""
        found = of_parameters(self.num_envs, lanes, self._names, self.parameters_of(lanes))
        if self._mixture is not None:
            found |= masked(self.num_envs, lanes, fidelity=self.fidelities[lanes])
        return found

    def _start(self, lanes: Array, given: list[dict[str, Any]] | None = None) -> None:
        """New episodes in the lanes (k,)."""
        step = self._step
        own = None if given is None else [given[lane] for lane in lanes]
        x, obs, w, p = self._starts.begin(lanes, self._randomise, own, lambda: self.np_random)
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
            if self._pictures[lane].scene.plant is self._played(lane).plant:
                self._pictures[lane].clear()
            else:
                self._pictures[lane] = renderer(self._played(lane))

    def _first_seen(self, channel: Channel, lanes: Array) -> None:
        """What is read first of episodes in the lanes (k,); those without a seed get one from the shared stream."""
        unseeded = channel.unseeded(lanes)
        if unseeded:
            channel.seed(unseeded, self.np_random.integers(2**62, size=len(unseeded)).tolist())
        shown, references = channel.begin(lanes, self._obs[lanes].astype(float))
        self._seen[lanes] = shown
        if references is not None:
            self._step.aim(lanes, references)

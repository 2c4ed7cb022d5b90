"""Randomised episodes for lanes, drawn before they are needed: many at a time cost less each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import cast

import numpy as np
from gymnasium.utils import seeding

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.signals import OwnsArrays

from .episode_start import begin, begin_each, draw, draw_each

Array = np.ndarray
DEPTH = 8  # episodes drawn ahead for a lane with its own stream: lanes end one by one, many are drawn at a time


class EpisodeSupply(OwnsArrays):
    """Episodes (x, obs, w, p) for lanes, from one stream of random numbers for all, or from a lane's own.

    Not `settled` they are what is drawn, (start, w, p): the coordinates that the scene's start names are no state yet.

    A lane that was given a seed of its own gets the episodes that a single environment of that seed plays, in their
    order, whatever the other lanes do. The others share one stream: its episodes go to whoever asks next.
    """

    def __init__(self, scene: Scene, lanes: int, *, settled: bool = True) -> None:
        self.scene, self.lanes, self.settled = scene, lanes, settled
        starts = (scene.plant.nx, len(scene.observe)) if settled else (len(scene.start),)
        self.widths = (*starts, scene.plant.nw, len(scene.varied_plant.varied))
        self._shared = [np.zeros((0, n)) for n in self.widths]
        self._streams: dict[int, int | np.random.Generator] = {}  # of lanes that have one: its seed until it is used
        self._seeded = np.zeros(lanes, dtype=bool)
        self._own: list[Array] = []  # rings (lanes, DEPTH, n) of their next episodes ..
        self._next_row = np.zeros(lanes, dtype=int)  # .. in which the very next stands here ..
        self._left = np.zeros(lanes, dtype=int)  # .. and so many are drawn

    def seed(self, lanes: Array, seeds: Sequence[int]) -> None:
        """From now on the episodes of the lanes (k,) come from streams of these seeds."""
        if not self._own:
            self._own = [np.zeros((self.lanes, DEPTH, n)) for n in self.widths]
        self._streams.update(zip(lanes.tolist(), seeds))
        self._seeded[lanes], self._left[lanes] = True, 0

    def generator(self, lane: int) -> np.random.Generator | None:
        """The lane's own stream, if it has one."""
        found = self._streams.get(lane)
        if isinstance(found, int):
            found = self._streams[lane] = seeding.np_random(found)[0]
        return found

    def take(self, lanes: Array, shared: Callable[[], np.random.Generator]) -> list[Array]:
        """The next episodes of the lanes (k,), each with k rows."""
        if len(self._streams) == self.lanes:
            return self._next_own(lanes)
        own = self._seeded[lanes]
        if not own.any():
            return self._next(len(lanes), shared)
        found = [np.zeros((len(lanes), n)) for n in self.widths]
        for whose, rows in ((own, self._next_own(lanes[own])), (~own, self._next(int((~own).sum()), shared))):
            for into, values in zip(found, rows):
                into[whose] = values
        return found

    def _next(self, n: int, shared: Callable[[], np.random.Generator]) -> list[Array]:
        if n > len(self._shared[0]):
            more = (begin if self.settled else draw)(self.scene, shared(), self.lanes)
            self._shared = [np.concatenate(pair) for pair in zip(self._shared, more)]
        taken = [a[:n] for a in self._shared]
        self._shared = [a[n:] for a in self._shared]
        return taken

    def _next_own(self, lanes: Array) -> list[Array]:
        left = self._left[lanes]
        if np.count_nonzero(left) < len(left):
            self._fill()
            left = self._left[lanes]
        rows = self._next_row[lanes]
        self._next_row[lanes], self._left[lanes] = (rows + 1) % DEPTH, left - 1
        return [a[lanes, rows] for a in self._own]

    def _fill(self) -> None:
        """Draw what is missing of all lanes that have a stream."""
        lanes = np.flatnonzero(self._seeded & (self._left < DEPTH))
        missing = DEPTH - self._left[lanes]
        streams = [cast(np.random.Generator, self.generator(lane)) for lane in lanes.tolist()]
        drawn = (begin_each if self.settled else draw_each)(self.scene, streams, missing.tolist())
        whose = np.repeat(lanes, missing)
        nth = np.arange(len(whose)) - np.repeat(np.cumsum(missing) - missing, missing)  # of those missing
        rows = (self._next_row[whose] + self._left[whose] + nth) % DEPTH
        for into, values in zip(self._own, drawn):
            into[whose, rows] = values
        self._left[lanes] = DEPTH

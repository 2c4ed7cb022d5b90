"""What lies between a policy and the machine, on lanes: late actions, late and noisy readings, memory, drawn goals.

Each lane has random numbers of its own, beside those of its episodes' starts, so that a lane of a seed meets what the
single environment of that seed meets, whatever the other lanes do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_period import reference
from pliant.envs.simulation.drawn_goals import allowed_offsets, goal_references
from pliant.plants.core.signals import OwnsArrays

from .task import Task

Array = np.ndarray
CHUNK = 64  # periods of noise that are drawn at a time for a lane
STREAM = 1  # tells a lane's stream from that of its episodes


class Channel(OwnsArrays):
    """`act` takes what a policy sends and gives what acts; `see` takes the signals and gives what it reads."""

    def __init__(self, scene: Scene, task: Task, lanes: int) -> None:
        self.scene, self.task, self.lanes = scene, task, lanes
        no, nu = len(scene.observe), scene.plant.nu
        self.deviations = task.deviations(scene)
        self.noisy = bool(self.deviations.any())
        self.first = np.clip(scene.initial[1] / np.array(scene.limits), -1.0, 1.0)
        self._streams: list[np.random.Generator | None] = [None] * lanes
        self._sent, self._act_late = _Line(task.action_delay[1], lanes, nu), np.zeros(lanes, dtype=int)
        self._read, self._see_late = _Line(task.observation_delay[1], lanes, no), np.zeros(lanes, dtype=int)
        self._noise, self._next = np.zeros((lanes, CHUNK, no if self.noisy else 0)), np.full(lanes, CHUNK)
        self._readings, self._actions = np.zeros((lanes, task.history, no)), np.zeros((lanes, task.history, nu))
        self._latest = np.zeros((lanes, nu))
        self._shift = np.zeros((lanes, no))  # what the scene's own goal shows less what the drawn one does
        self._goal = np.zeros((lanes, len(scene.goal) if task.goal_spread else 0))

    @property
    def width(self) -> int:
        """How many numbers a policy reads."""
        no, nu = self.deviations.size, self.first.size
        return no + self.task.history * (no + nu) + self._goal.shape[1]

    def seed(self, lanes: Sequence[int] | Array, seeds: Sequence[Any]) -> None:
        """From now on the lanes draw from streams of these seeds."""
        for lane, seed in zip(lanes, seeds):
            self._streams[lane] = np.random.default_rng([STREAM, int(seed)])
            self._next[lane] = CHUNK

    def unseeded(self, lanes: Array) -> list[int]:
        """Those of the lanes that have no stream yet."""
        return [int(lane) for lane in lanes if self._streams[lane] is None]

    def begin(self, lanes: Array, obs: Array) -> tuple[Array, Array | None]:
        """New episodes in the lanes (k,) that show obs (k, no): what is read first (k, width), and the references
        (k, nr) of their goals where these are drawn.
        """
        task, references = self.task, None
        for late, (least, most) in ((self._act_late, task.action_delay), (self._see_late, task.observation_delay)):
            if least == most:
                late[lanes] = most
            else:
                late[lanes] = [self._stream(lane).integers(least, most + 1) for lane in lanes]
        if task.goal_spread:
            share = np.array([self._stream(lane).random(self._goal.shape[1]) for lane in lanes])
            self._goal[lanes] = allowed_offsets(self.scene, task.goal_spread * (2.0 * share - 1.0))
            references = goal_references(self.scene, self._goal[lanes])
            self._shift[lanes] = (reference(self.scene) - references)[:, : obs.shape[1]]
            obs = obs + self._shift[lanes]
        self._sent.fill(lanes, self.first)
        self._read.fill(lanes, obs)
        reading = obs + self._errors(lanes)
        self._readings[lanes], self._actions[lanes] = reading[:, None], 0.0
        return np.hstack([reading, *self._remembered(lanes), self._goal[lanes]]), references

    def act(self, actions: Array) -> Array:
        """What acts in this period, (lanes, nu), where `actions` are sent."""
        self._latest = np.clip(actions, -1.0, 1.0)
        return self._sent.pass_on(self._latest, self._act_late)

    def see(self, obs: Array, waiting: Array) -> Array:
        """What is read (lanes, width) where the signals are obs (lanes, no), those of the lane's goal; lanes that wait
        for their next episode read nothing.
        """
        every = np.arange(self.lanes)
        seen = self._read.pass_on(obs, self._see_late)
        if self.noisy:
            seen = seen + self._errors(np.setdiff1d(every, waiting), every)
        if not self.task.history:
            return np.hstack([seen, self._goal]) if self._goal.shape[1] else seen
        self._actions[:, 1:], self._actions[:, 0] = self._actions[:, :-1].copy(), self._latest
        found = np.hstack([seen, *self._remembered(every), self._goal])
        self._readings[:, 1:], self._readings[:, 0] = self._readings[:, :-1].copy(), seen
        return found

    def _remembered(self, lanes: Array) -> list[Array]:
        return [a[lanes].reshape(len(lanes), -1) for a in (self._readings, self._actions)]

    def _errors(self, lanes: Array, among: Array | None = None) -> Array:
        """The next errors of readings of the lanes, in rows of their own or, zero for others, in those `among` all."""
        if not self.noisy:
            return np.zeros((1, self.deviations.size))
        for lane in lanes[self._next[lanes] == CHUNK].tolist():
            self._noise[lane] = self.deviations * self._stream(lane).standard_normal(self._noise.shape[1:])
            self._next[lane] = 0
        errors = self._noise[lanes, self._next[lanes]]
        self._next[lanes] += 1
        if among is None or len(lanes) == len(among):
            return errors
        found = np.zeros((len(among), errors.shape[1]))
        found[lanes] = errors
        return found

    def _stream(self, lane: int) -> np.random.Generator:
        found = self._streams[lane]
        assert found is not None, "seeded before the first episode"
        return found


class _Line(OwnsArrays):
    """Rows on their way: each lane gets what was put in so many periods ago."""

    def __init__(self, most: int, lanes: int, width: int) -> None:
        self.kept, self.now, self.every = np.zeros((most + 1, lanes, width)), 0, np.arange(lanes)

    def fill(self, lanes: Array, rows: Array) -> None:
        """As if `rows` had always been put in."""
        self.kept[:, lanes] = rows

    def pass_on(self, rows: Array, late: Array) -> Array:
        """Put in rows (lanes, width); what was put in `late` (lanes,) periods ago."""
        length = len(self.kept)
        if length == 1:
            return rows
        self.now = (self.now + 1) % length
        self.kept[self.now] = rows
        return self.kept[(self.now - late) % length, self.every]

"""What lanes go through while one action is held: a control period, or several, each charged as the scene charges it.

A lane whose episode ends before the action does stays where it ended: its state, its readings, its time.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pliant.envs.simulation.episode_start import early_end_cost
from pliant.envs.tasks import Task, infos, normalised, shares

from .batch import Batch

Array = np.ndarray


class Played(NamedTuple):
    """Of lanes, (num_envs,) each: what the periods cost and earned, how they ended, what is told of single lanes."""

    cost: Array
    reward: Array
    terminated: Array
    truncated: Array
    diverged: Array
    early: Array | None  # the part of the cost that is charged for the time left
    told: dict[str, Any]


class HeldPeriods(Batch):
    """A batch that plays on: `task.hold` control periods with one action."""

    task: Task
    _steps: int  # control periods of an episode
    _dtype: np.dtype

    def _held(self, actions: Array, waiting: Array) -> Played:
        """Hold actions (num_envs, nu) in lanes that do not wait; lanes that wait, (k,), stay."""
        hold, scene = self.task.hold, self.scene
        actions = shares(scene, self.task.actions, actions)
        found = self._period(actions, waiting)
        if hold == 1:
            return found
        share = 1.0 if self.task.reward == "cost" else 1.0 / hold
        found = found._replace(reward=share * found.reward)
        for _ in range(1, hold):
            over = found.terminated | found.truncated
            over[waiting] = True
            idle = over.nonzero()[0]
            if len(idle) == self.num_envs:
                break
            step = self._step
            kept = step.x[:, idle].copy(), self._obs[idle].copy(), self._seen[idle].copy(), self._done[idle].copy()
            more = self._period(actions, idle)
            step.x[:, idle], self._obs[idle], self._seen[idle], self._done[idle] = kept
            found = _together(found, more, idle, share)
        return found

    def _period(self, actions: Array, waiting: Array) -> Played:
        """One control period."""
        step, scene, task, channel = self._step, self.scene, self.task, self._channel
        if channel is not None:
            actions = channel.act(actions)
        step.action[:] = actions.T
        step.begin(self._done)
        terms = self._terms(waiting) if task.terms else None
        diverged, outside = step.run()
        self._done += 1
        cost = step.cost.astype(float)
        terminated = diverged | outside if task.constraint == "end" else diverged.copy()
        last, self._obs = self._obs, step.obs.T.copy()
        if len(waiting):  # these lanes start again instead
            terminated[waiting] = diverged[waiting] = False
            self._done[waiting] = 0
            cost[waiting] = 0.0
        bounded = None if task.reward == "cost" else normalised(scene, cost, terminated)
        early = None
        if np.count_nonzero(terminated):
            self._obs[diverged] = last[diverged]
            left = terminated.nonzero()[0]
            early = np.zeros(self.num_envs)
            early[left] = early_end_cost(scene, self._done[left], cost[left])
            cost += early
        if self.render_mode is not None:
            self._total += cost
        truncated = (self._done >= self._steps) & ~terminated
        told: dict[str, Any] = {}
        invalid = step.reach > 1.0
        if np.count_nonzero(invalid):
            invalid &= ~diverged
            invalid[waiting] = False
            if invalid.any():
                told = {"validity": np.where(invalid, step.reach, 0.0), "_validity": invalid}
        if terms is not None:
            told |= terms
        if task.constraint == "cost":
            playing = np.setdiff1d(np.arange(self.num_envs), waiting)
            told |= infos.masked(self.num_envs, playing, cost_constraint=(outside | diverged)[playing].astype(float))
        if channel is not None:
            self._seen = channel.see(self._obs.astype(float), waiting).astype(self._dtype)
        else:
            self._seen = self._obs
        reward = 0.0 - cost if bounded is None else bounded  # no -0 where nothing is charged
        if bounded is not None and len(waiting):
            reward[waiting] = 0.0
        return Played(cost, reward, terminated, truncated, diverged, early, told)


def _together(found: Played, more: Played, idle: Array, share: float) -> Played:
    """What was played before and one period more, in which the lanes `idle` had no part."""
    early = found.early if more.early is None else more.early + (0.0 if found.early is None else found.early)
    return Played(
        found.cost + more.cost,
        found.reward + share * more.reward,
        found.terminated | more.terminated,
        found.truncated | _but(more.truncated, idle),
        found.diverged | more.diverged,
        early,
        infos.of_both_periods(found.told, more.told),
    )


def _but(mask: Array, lanes: Array) -> Array:
    """The mask without these lanes."""
    found = mask.copy()
    found[lanes] = False
    return found

"""Lanes of a scene in PufferLib's buffers: `reset` and `step` write into arrays that others hold.

PufferLib 3's native environments hold many agents each. An agent here is a lane: it knows nothing of the others. What
is exchanged are arrays that the library owns, often slices of shared memory, and that are only ever written into:

    observations (num_agents, no), actions (num_agents, nu), rewards (num_agents,)   float32
    terminals, truncations, masks (num_agents,)   bool; masks, the agents that live, are all of them, always

An episode that ends starts again in the same step: the observation is then the next episode's first. Infos are a list
of dictionaries of numbers, of which the library takes the mean of each key.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode

from pliant.envs.environments.arguments import require_seed
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import shown

Array = np.ndarray
OWN: dict[str, Any] = {"dtype": "float32", "autoreset_mode": AutoresetMode.SAME_STEP}  # PufferLib's conventions
BUFFERS = ("observations", "rewards", "terminals", "truncations", "masks", "actions")


class PufferLanes:
    """What an environment of PufferLib does, without the library: who makes the buffers sets them as attributes.

    Keywords are PlantVectorEnv's but `dtype` and `autoreset_mode`, which are PufferLib's (ValueError); those of
    `Task` are among them. `reset(seed=s)` seeds lane i with s * num_agents + i, which then plays the episodes of
    PlantEnv.reset(seed=that): environments of seeds s, s + 1, .., as PufferLib gives them, share no episode.
    `reset()` goes on from the seed before, or begins with that of the constructor. infos: where episodes end, one
    dictionary of means over these: "episode_return", "episode_length" (actions), "cost", which the scene charges for
    the last action, "diverged".

    Example
    -------
    >>> from pliant.envs import scenes
    >>> lanes = PufferLanes(scenes.get("single-link-slew"), 8, reward="normalised")
    >>> lanes.num_agents, lanes.single_action_space.shape
    (8, (1,))
    """

    observations: Array
    rewards: Array
    terminals: Array
    truncations: Array
    masks: Array
    actions: Array

    def __init__(self, scene: str | Scene, num_envs: int, *, seed: int | None = 0, **options: Any) -> None:
        if given := sorted(options.keys() & OWN):
            raise ValueError(f"PufferLanes: {given[0]} = {shown(options[given[0]])} must be left out")
        self.vector = PlantVectorEnv(scene, num_envs, **OWN, **options)
        self.num_agents = self.vector.num_envs
        self.single_observation_space = self.vector.single_observation_space
        self.single_action_space = self.vector.single_action_space
        self.render_mode = self.vector.render_mode
        self._seed = require_seed("PufferLanes", seed)
        self._return, self._length = np.zeros(self.num_agents), np.zeros(self.num_agents, dtype=int)

    def reset(self, seed: int | None = None) -> tuple[Array, list[dict[str, float]]]:
        """New episodes in all lanes: (observations, []). ValueError for a seed that is none."""
        seed = require_seed("PufferLanes.reset", seed)
        if seed is None and not self.vector.begun:
            seed = self._seed
        obs, _ = self.vector.reset(seed=None if seed is None else seed * self.num_agents)
        self.observations[:] = obs
        for flags in (self.rewards, self.terminals, self.truncations, self._return, self._length):
            flags[:] = 0
        self.masks[:] = True
        return self.observations, []

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, list[dict[str, float]]]:
        """Hold actions (num_agents, nu) in every lane: the buffers, and infos. ResetNeeded before the first reset;
        ValueError for actions of another shape, or not finite.
        """
        obs, reward, terminated, truncated, _, ended, _ = self.vector.advance(actions)
        self.actions[:] = actions
        self.observations[:], self.rewards[:] = obs, reward
        self.terminals[:], self.truncations[:] = terminated, truncated
        self._return += reward
        self._length += 1
        infos = []
        if ended is not None:
            over = ended.lanes
            told = (self._return[over], self._length[over], ended.cost, ended.diverged)
            infos = [
                dict(zip(("episode_return", "episode_length", "cost", "diverged"), (float(a.mean()) for a in told)))
            ]
            self._return[over] = self._length[over] = 0
        return self.observations, self.rewards, self.terminals, self.truncations, infos

    def render(self) -> Array | None:
        """A picture (height, width, 3) uint8 of the first lane; None unless render_mode is "rgb_array"."""
        drawn = self.vector.render()
        return None if drawn is None else drawn[0]

    def notify(self) -> None:
        """What PufferLib tells its environments to do, which ours do not need."""

    def close(self) -> None:
        """Nothing is held open; may be called again."""
        self.vector.close()

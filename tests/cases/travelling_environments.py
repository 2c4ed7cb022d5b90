"""Environments that travel in the middle of an episode, scenes and rollouts."""

from __future__ import annotations

from typing import Any

import numpy as np
from travelling import SLEW, Roll, fields

from pliant.controllers import (
    LQR,
)  # fmt: skip
from pliant.envs import PlantEnv
from pliant.studies.closed_loop.rollout import randomised, rollout

ROLL = Roll()
traveller, record = ROLL.traveller, ROLL.record


def env_goes(env: Any) -> Any:
    found = []
    for k in range(5):
        found.append(env.step(np.full(env.action_space.shape, 0.1 * (k + 1), dtype=np.float32)))
    found.append(env.reset())  # of the generator that travels too
    return [part[:4] for part in found]


@traveller("environment", env_goes)
def _env() -> Any:
    env = PlantEnv(SLEW, randomise=True)
    env.reset(seed=3)
    env.step(np.array([0.5], dtype=np.float32))
    return env


@traveller("vector environment", env_goes)
def _vector() -> Any:
    env = SLEW.vector_env(3, randomise=True)
    env.reset(seed=3)
    env.step(np.full((3, 1), 0.5, dtype=np.float32))
    return env


def sb3_goes(env: Any) -> Any:
    found = []
    for k in range(4):
        env.step_async(np.full((env.num_envs, 1), 0.1 * k, dtype=np.float32))
        found.append(env.step_wait()[:3])
    return found, env.reset()


@traveller("Stable-Baselines3 environment", sb3_goes)
def _sb3() -> Any:
    env = SLEW.sb3_env(3, randomise=True)
    env.seed(3)
    env.reset()
    return env


@traveller(
    "scene", lambda s: (s.initial, s.target, s.plant.dynamics(s.initial[0]), s.draw(0) if hasattr(s, "draw") else ())
)
def _scene() -> Any:
    return SLEW


record("quadratic cost")(lambda: SLEW.quadratic())


@traveller("conditions and rollout", fields)
def _rollout() -> Any:
    given = randomised(SLEW, 1, 3)[0]
    return given, rollout(SLEW, LQR.for_scene(SLEW), given)

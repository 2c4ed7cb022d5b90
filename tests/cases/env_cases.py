"""Every registered environment, and how to play one."""

import gymnasium
import numpy as np

import pliant.envs
from pliant.envs import scenes

IDS = [pliant.envs.environment_id(name) for name in scenes.names()]


def play(env: gymnasium.Env, actions: np.ndarray) -> list[tuple]:
    """Steps until the episode or the actions end."""
    seen = []
    for action in actions:
        seen.append(env.step(action))
        if seen[-1][2] or seen[-1][3]:
            break
    return seen

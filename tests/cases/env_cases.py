"""Every registered environment, and how to play one."""

import gymnasium
import numpy as np
import pytest

import pliant.envs
from pliant.envs import scenes

IDS = [pliant.envs.environment_id(name) for name in scenes.names()]
SAMPLE = ("pliant/SingleLinkSlew-v0", "pliant/TwoLinkReach-v0", "pliant/SpinUp-v0", "pliant/SpacecraftSlew-v0")
SAMPLED = [  # for what is long: a sample in `make test`, the others in `make campaign`
    *SAMPLE,
    *(pytest.param(env_id, marks=pytest.mark.campaign) for env_id in IDS if env_id not in SAMPLE),
]


def play(env: gymnasium.Env, actions: np.ndarray) -> list[tuple]:
    """Steps until the episode or the actions end."""
    seen = []
    for action in actions:
        seen.append(env.step(action))
        if seen[-1][2] or seen[-1][3]:
            break
    return seen

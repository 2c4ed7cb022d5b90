"""The native vector environment as a PufferEnv of PufferLib 3."""

from __future__ import annotations

from typing import Any

import pufferlib

from pliant.envs.scenes.scene import Scene

from .puffer_lanes import PufferLanes


class PlantPufferEnv(PufferLanes, pufferlib.PufferEnv):
    """`num_envs` agents of a scene in the buffers `buf` that PufferLib hands over, or its own; see `PufferLanes`."""

    def __init__(self, scene: str | Scene, num_envs: int, *, buf: Any = None, seed: int = 0, **options: Any) -> None:
        PufferLanes.__init__(self, scene, num_envs, seed=seed, **options)
        pufferlib.PufferEnv.__init__(self, buf)

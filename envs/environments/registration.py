"""The ids under which Gymnasium knows the scenes."""

from __future__ import annotations

import gymnasium

from pliant.envs import scenes
from pliant.envs.scenes import registry

from .thresholds import THRESHOLDS


def environment_id(scene_name: str) -> str:
    """The registered id of a named scene: "two-link-reach" -> "pliant/TwoLinkReach-v0"."""
    return f"pliant/{''.join(word.capitalize() for word in scene_name.split('-'))}-v0"


def register() -> None:
    """Register every named scene with Gymnasium, and each that is registered later; the environment keeps the time
    limit, so no wrapper does.
    """
    for name in (*scenes.names(), *registry.VARIANTS):
        _register(name)
    if _register not in registry.HEARERS:
        registry.HEARERS.append(_register)


def _register(name: str) -> None:
    """ValueError where the id is another scene's: "a-1b" and "a1b" would both be "A1b"."""
    made = environment_id(name)
    known = gymnasium.registry.get(made)
    if known is not None and known.kwargs.get("scene") != name:
        raise ValueError(f"scene {name!r}: its environment {made!r} is that of {known.kwargs.get('scene')!r}")
    if known is None:
        gymnasium.register(
            id=made,
            entry_point="pliant.envs.environments.env:PlantEnv",
            vector_entry_point="pliant.envs.environments.vector_env:PlantVectorEnv",
            reward_threshold=THRESHOLDS.get(name),
            kwargs={"scene": name},
        )

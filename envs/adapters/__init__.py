"""A scene's lanes by the conventions of PufferLib, which is imported where it is asked for."""

from typing import Any

from pliant.envs.scenes.scene import ENVIRONMENTS, Scene

from .puffer_lanes import PufferLanes

__all__ = ["PufferLanes"]


def _puffer(scene: Scene, num_envs: int, **options: Any) -> Any:
    """A PlantPufferEnv; its module is a subclass of pufferlib's, which is optional and loads torch."""
    from .puffer_env import PlantPufferEnv

    return PlantPufferEnv(scene, num_envs, **options)


ENVIRONMENTS.update(puffer=_puffer)

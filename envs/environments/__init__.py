"""PlantEnv, PlantVectorEnv, PlantVecEnv (SB3), registration; `Scene.vector_env` and `.sb3_env` make theirs here."""

from typing import Any

from pliant.envs.scenes.scene import ENVIRONMENTS, Scene

from .env import PlantEnv
from .registration import environment_id, register
from .vector_env import PlantVectorEnv

__all__ = ["PlantEnv", "PlantVectorEnv", "environment_id", "register"]


def _sb3(scene: Scene, num_envs: int, **options: Any) -> Any:
    """A PlantVecEnv; its module is a subclass of stable_baselines3's, which is optional and loads torch."""
    from .sb3_env import PlantVecEnv

    return PlantVecEnv(scene, num_envs, **options)


ENVIRONMENTS.update(vector=PlantVectorEnv, sb3=_sb3)

"""Scenes wrapped for learning: `import pliant.envs` registers every scene as a Gymnasium environment."""

if __name__ != "pliant.envs":
    raise ImportError("this folder is installed as pliant.envs: write `import pliant.envs`")

from . import scenes
from .env import PlantEnv, environment_id, register
from .scene import Scene

register()

__all__ = ["PlantEnv", "Scene", "environment_id", "scenes"]

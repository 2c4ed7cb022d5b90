"""What a scene is, and those that have a name: `scenes.get(name)`, `scenes.register(scene)`, `scenes.load(path)`."""

from pliant.plants.integration.minimum_jerk import minimum_jerk

from .registry import SCENES, get, load, names, register
from .scene import Scene

__all__ = ["SCENES", "Scene", "get", "load", "minimum_jerk", "names", "register"]

"""What a scene is, and the named ones: `scenes.get("two-link-reach")`."""

from pliant.plants.integration.minimum_jerk import minimum_jerk

from .registry import SCENES, get, names
from .scene import Scene

__all__ = ["SCENES", "Scene", "get", "minimum_jerk", "names"]

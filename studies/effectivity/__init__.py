"""How far predicted errors are from true ones, on random scenes against models of no ladder."""

from .effectivity import Effectivity, effectivity
from .random_scenes import Drawn, random_scene

__all__ = ["Drawn", "Effectivity", "effectivity", "random_scene"]

"""Verdicts of scenes, maps over parameters."""

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for
    from .campbell_picture import campbell_diagram
    from .parameter_map import StabilityMap, map_stability

__all__ = ["StabilityMap", "campbell_diagram", "map_stability"]

imports.offer(
    __name__,
    {
        "campbell_picture": "campbell_diagram",
        "parameter_map": "StabilityMap map_stability",
    },
)

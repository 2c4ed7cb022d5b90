"""Verdicts of scenes, maps over parameters."""

from .campbell_picture import campbell_diagram
from .parameter_map import StabilityMap, map_stability

__all__ = ["StabilityMap", "campbell_diagram", "map_stability"]

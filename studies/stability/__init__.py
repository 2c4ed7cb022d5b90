"""Verdicts of scenes, maps over parameters."""

from .parameter_map import StabilityMap, map_stability

__all__ = ["StabilityMap", "map_stability"]

"""Machines that turn: their modes over the speed, and where these meet what excites them.

campbell(plant, speeds)   frequencies over the speed, modes followed by their shapes, crossings: `campbell`
multi_blade(n)            coordinates of bodies that repeat about an axis: `multi_blade`
"""

from __future__ import annotations

from .campbell import Campbell, Crossing, campbell
from .multi_blade import multi_blade, multi_blade_model

__all__ = ["Campbell", "Crossing", "campbell", "multi_blade", "multi_blade_model"]

"""Machines that turn: their modes over the speed, and where these meet what excites them.

campbell(plant, speeds)   frequencies over the speed, modes followed by their shapes, crossings: `campbell`
output_mode(model, cycle)  Floquet modes in what is measured: `floquet_modes`
multi_blade(n)            coordinates of bodies that repeat about an axis: `multi_blade`
"""

from __future__ import annotations

from .campbell import Campbell, Crossing, campbell
from .floquet_modes import OutputMode, output_mode
from .multi_blade import multi_blade, multi_blade_model

__all__ = ["Campbell", "Crossing", "OutputMode", "campbell", "multi_blade", "multi_blade_model", "output_mode"]

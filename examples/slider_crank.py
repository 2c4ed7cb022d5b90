"""The steady cycle of a slider-crank with an elastic rod, and the linear periodic model along it."""

import numpy as np

from pliant.plants import SliderCrank
from pliant.plants.slider_crank.steady_cycles import floquet_multipliers, steady_cycle

plant = SliderCrank.textbook()  # 144 rpm, 20 N, r = 55 mm, l = 280 mm
cycle = steady_cycle(plant)
bend = cycle["mid_deflection"]
print(f"rod bends from {bend.min() * 1e6:.3f} to {bend.max() * 1e6:.3f} um over a cycle of {cycle.t[-1]:.4f} s")
names = tuple(s.name for s in plant.states if s.name.startswith("eta"))
multipliers = floquet_multipliers(plant.linearize_along(cycle), names)
print(f"largest Floquet multiplier {np.abs(multipliers).max():.4f}: the bending decays")

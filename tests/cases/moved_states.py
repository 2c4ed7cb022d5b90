"""Random states of a plant, all of it moving."""

import numpy as np


def moved(plant, seed, size=1.0):
    """x (nx,) with entries up to `size`, quaternions of unit length."""
    return plant.consistent(size * np.random.default_rng(seed).uniform(-1, 1, plant.nx))

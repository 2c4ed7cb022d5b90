"""A 10 m cantilever let go under gravity: three coordinates of the strain-parametrised beam follow it."""

import dataclasses

import numpy as np

from pliant.plants import LargeDeflectionBeam

beam = LargeDeflectionBeam.textbook()  # 3 coordinates, 6 states
t = np.linspace(0.0, 3.0, 61)
drop = beam.simulate(np.zeros(beam.nx), None, t)
fine = dataclasses.replace(beam, modes=8)
truth = fine.simulate(np.zeros(fine.nx), None, t, rtol=1e-8)
k = int(np.argmin(drop["tip_v"]))
error = np.hypot(drop["tip_u"] - truth["tip_u"], drop["tip_v"] - truth["tip_v"]).max()
print(f"lowest at {t[k]:.2f} s: {drop['tip_v'][k]:.3f} m; with 8 coordinates the tip moves by {error * 1e3:.2f} mm")

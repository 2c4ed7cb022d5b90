"""A linear time-varying model about a moving nominal that a rigid program made: the residual stays in it as c(t)."""

import numpy as np

from pliant.envs import scenes
from pliant.plants import Trajectory

scene = scenes.get("single-link-slew")
arm, rigid = scene.plant, scene.plant.ladder()[0]
t = np.linspace(0.0, 1.2, 241)
slew = rigid.simulate([0.0, 0.0], scene.nominal_input, t)  # two states: angle and rate

x = np.zeros((len(t), arm.nx))  # the elastic states stay at zero: not a motion of the elastic arm
x[:, 0], x[:, arm.coordinates_slice.stop] = slew["hub_angle"], slew["hub_angle_rate"]
ltv = arm.linearize_along(Trajectory.from_arrays(t, x, slew.u, plant=arm))
_, dy = ltv.simulate(np.zeros(arm.nx))

truth = arm.simulate(np.zeros(arm.nx), scene.nominal_input, t)
bend = truth["tip_deflection"]
missed = np.abs(dy[:, 1] - bend).max()
print(f"peak deflection {np.abs(bend).max() * 1e3:.3f} mm, of which the linear model misses {missed * 1e6:.3f} um")

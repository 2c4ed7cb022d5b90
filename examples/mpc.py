"""Predictive control: a link bends no more than it may, and a payload that nobody told of leaves no steady error."""

from dataclasses import replace

import numpy as np

from pliant.controllers import LQR, MPC
from pliant.envs import scenes

scene = scenes.get("two-link-reach")
arm, start = scene.plant, scene.initial[0]
lqr = LQR.for_scene(scene)
mpc = MPC.for_scene(scene, horizon=20, bounds={"tip1_deflection": (-0.1, 0.1)})  # [m], exceeded only where it must be
for controller in (lqr, mpc):
    motion = arm.simulate(start, controller, scene.times)
    bend = 1e3 * np.abs(motion["tip1_deflection"]).max()
    print(f"{type(controller).__name__} bends link 1 by up to {bend:.1f} mm at a cost of {scene.cost(motion):.2f}")
print(f"{mpc.record.limited} of {mpc.record.calls} acts met a limit, {mpc.record.violations} exceeded a soft one")

heavier = replace(arm, payload=replace(arm.payload, mass=0.6))  # the design model carries 0.5 kg
offset_free = MPC.for_scene(scene, track=("theta1", "theta2"))
for name, controller in (("LQR", lqr), ("MPC with a disturbance estimate", offset_free)):
    motion = heavier.simulate(start, controller, np.arange(0.0, 6.01, scene.dt))
    error = 1e3 * np.abs(motion.x[-1, :2] - scene.target[0][:2]).max()
    print(f"{name}: joints {error:.3f} mrad off with 0.6 kg")

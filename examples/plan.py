"""Plan a slew that bends the arm less, and look at it under the plant integrated to 1e-10."""

import numpy as np

from pliant.controllers import plan
from pliant.envs import scenes

scene = scenes.get("single-link-slew")  # 40 N m at the hub; the plan keeps a tenth of it for feedback
arm = scene.plant
for name, limits in (("free", None), ("gentle", {"tip_deflection": 0.006, "hub_angle_rate": 1.8})):
    found = plan(scene, time=1.0, bounds=limits)
    bend = found.trajectory(arm)["tip_deflection"]
    held = np.vstack([found.u, np.zeros((51, 1))])  # then nothing for a second
    motion = arm.simulate(found.x[0], held, scene.dt * np.arange(len(held)))
    rest = np.abs(motion["tip_deflection"][len(found.t) :]).max()
    print(
        f"{name}: peak torque {np.abs(found.u).max():.2f} N m, tip bends {np.abs(bend).max() * 1e3:.2f} mm, "
        f"then rings by {rest * 1e6:.2f} um; {found.iterations} iterations in {found.seconds:.1f} s"
    )

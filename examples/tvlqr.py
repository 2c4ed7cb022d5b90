"""A regulator along a planned motion of a two-link elastic arm, its funnel, and the arm with another payload."""

import dataclasses

import numpy as np

from pliant.controllers import TVLQR
from pliant.envs import scenes
from pliant.plants import Payload

scene = scenes.get("two-link-reach")
law = TVLQR.for_scene(scene)  # plans the motion, then designs along it and about the goal
print(f"{len(law.x) - 1} periods of {law.dt} s, reads {', '.join(law.reads[:3])}, ..")

start = scene.initial[0] + np.eye(12)[0] * 0.01  # theta1 is 10 mrad off
print(f"from here the law uses {law.funnel.use(0.0, start):.2f} of its funnel: {law.funnel.inside(0.0, start)}")
motion = scene.plant.simulate(start, law, scene.times)
error = np.hypot(*(motion[n] - motion[n][-1] for n in ("tip_x", "tip_y")))
print(f"tip within {error[100:].max() * 1e3:.3f} mm of its goal from 2 s on")

heavy = dataclasses.replace(scene.plant, payload=Payload(mass=1.2 * scene.plant.payload.mass))
motion = heavy.simulate(scene.initial[0], law, scene.times)  # 20 % more payload: off by what gravity adds
off = motion["theta1"][-1] - scene.target[0][0]
print(f"with 20 % more payload theta1 stays {off * 1e3:.1f} mrad off")

"""Collocated PD whose gains are chosen on the sampled elastic loop, beside computed torque tuned as for a rigid arm."""

import numpy as np

from pliant.controllers import PD, ComputedTorque
from pliant.controllers.joint_control.collocation import loop_eigenvalues
from pliant.envs import scenes

scene = scenes.get("two-link-reach")
arm, (goal, hold) = scene.plant, scene.target
pd, rival = PD.for_scene(scene), ComputedTorque.for_scene(scene)
for law in (pd, rival):
    motion = arm.simulate(scene.initial[0], law, scene.times, rtol=1e-6, atol=1e-8)
    off = np.hypot(motion["theta1"][-1] + 0.9, motion["theta2"][-1] - 0.6)
    print(f"{type(law).__name__}: cost {scene.cost(motion):.2f}, joints {off:.3f} rad off after {scene.duration} s")

slowest = -loop_eigenvalues(arm.linearize(goal, hold), pd.K, pd.reads, scene.dt).real.max()
print(f"the PD loop's slowest mode decays at {slowest:.2f} 1/s")

"""Rigid computed torque on an elastic arm with a light hub: tuned as for a rigid arm, its sampled loop is unstable.

What a motor turns at once is the bare hub, 0.02 kg m^2, not the arm of some kg m^2 that the rigid model puts there, so
Kd dt over the hub's inertia is far above 2, where a sampled rate loop on an inertia becomes unstable
(z = 1 - Kd dt / J < -1).
"""

import dataclasses

import numpy as np

from pliant.controllers.joint_control.collocation import loop_eigenvalues, rigid_inertia, rows
from pliant.controllers.joint_control.computed_torque import PATIENCE, ComputedTorque
from pliant.controllers.joint_control.pd import PD
from pliant.envs import scenes


def test_tuned_as_rigid_it_shakes_the_arm_and_the_loop_said_so() -> None:
    scene = scenes.get("two-link-reach")
    arm, (x0, u0) = scene.plant, scene.target
    naive = ComputedTorque.for_scene(scene)
    error = {}
    for name, plant in (("rigid", arm.ladder()[0]), ("elastic", arm)):
        played = scene.with_plant(plant)
        motion = plant.simulate(played.initial[0], naive, scene.times, rtol=1e-6, atol=1e-8)
        error[name] = np.hypot(motion["theta1"][-1] + 0.9, motion["theta2"][-1] - 0.6)
    assert error["rigid"] < 1e-3  # on the arm it was made for it is right
    assert error["elastic"] > 0.05

    bandwidth = PATIENCE / scene.move_time  # noticed before any simulation: about the goal it is this PD
    J = rigid_inertia(arm, x0, u0, naive.joints.rates)
    K = np.hstack([bandwidth**2 * J, 2 * bandwidth * J])
    model = arm.linearize(x0, u0)
    assert loop_eigenvalues(model, K, naive.reads, scene.dt).real.max() > 10.0
    hub = np.linalg.inv(rows(model, naive.joints.rates) @ model.B)
    assert scene.dt * np.linalg.eigvals(2 * bandwidth * J @ np.linalg.inv(hub)).real.max() > 2.0
    assert loop_eigenvalues(model, K, naive.reads, None).real.max() < 10.0  # sampling is what breaks it most

    law = PD.for_scene(scene)  # recommended: gains chosen on the sampled elastic loop
    assert loop_eigenvalues(model, law.K, law.reads, scene.dt).real.max() < -0.5
    longer = dataclasses.replace(scene, duration=8.0)
    motion = arm.simulate(longer.initial[0], law, longer.times, rtol=1e-6, atol=1e-8)
    assert np.hypot(motion["theta1"][-1] + 0.9, motion["theta2"][-1] - 0.6) < 0.02
    assert longer.cost(motion) < 5.0

"""A policy is judged by the scene's own cost, here added up period by period."""

import numpy as np
import pytest

from pliant.controllers import Policy, rl
from pliant.envs import scenes


def test_cost_is_the_scenes_own_of_the_same_motion():
    scene = scenes.get("single-link-slew")
    policy = Policy.for_scene("single-link-slew")
    step = scene.plant.stepper(scene.dt, substeps=scene.substeps)
    x, cost = scene.initial[0], 0.0
    known = [s.name for s in scene.signals]
    places = [known.index(name) for name in policy.reads]
    policy.reset()
    u = scene.initial[1]
    for k in range(scene.steps):
        u = policy.act(k * scene.dt, np.concatenate([x, scene.plant.measure(x, u)])[places])
        cost += scene.dt * float(scene.stage_cost(x, u, scene.plant.measure(x, u)))
        x = step(x[None], u[None])[0]
    assert rl.evaluate(policy, scene) == pytest.approx(cost, rel=2e-2)

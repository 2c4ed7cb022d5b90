"""The lanes that a training steps: what they charge, and where they start."""

import numpy as np
import pytest

from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")


def test_lanes_charge_as_their_docstring_says(stable_baselines):
    from pliant.controllers.learning import training_env as module

    lanes = module.TrainingLanes(SCENE, 4, spread=0.0, bounded=False, seed=0, threads=1)
    lanes.venv.reset()
    rate = 10.0  # the slew's: weight 10 on an error of 1 rad
    assert lanes.unit == pytest.approx(0.5 * rate)
    raw = np.array([-0.01, -0.2, -3.0, -500.0])
    infos = [{}, {}, {}, {"TimeLimit.truncated": False}]
    lanes.venv.step_wait = lambda: (None, raw, np.array([False, False, False, True]), infos)
    lanes.venv.step_async = lambda actions: None
    lanes.step_async(np.array([[0.0], [2.0], [0.0], [0.0]]))
    _, rewards, _, _ = lanes.step_wait()
    knee = module.KNEE * SCENE.dt * rate / lanes.unit
    wanted = [-0.002, -0.04 - module.EXCESS, -knee * (1 + np.log(0.6 / knee)), -module.EARLY_END]
    assert rewards == pytest.approx(wanted, rel=1e-5)


def test_lanes_start_out_of_step(stable_baselines):
    from pliant.controllers.learning.training_env import TrainingLanes

    lanes = TrainingLanes(SCENE, 64, spread=1.5, bounded=False, seed=0, threads=1)
    obs = lanes.reset()
    assert len(np.unique(lanes.venv.vector._done)) > 20
    assert obs[:, 0].min() < -1.5 and obs[:, 0].max() > 0.2  # on both sides of the goal
    assert np.isfinite(obs).all() and lanes.seen.shape == (64 * SCENE.steps, 4)
    again = lanes.reset()
    assert np.array_equal(obs, again)
    lanes.close()

"""The state when the next input begins to act, against a simulation with finer steps and held pieces."""

import pickle

import numpy as np
import pytest

from pliant.controllers.linear_quadratic.state_ahead import StateAhead
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")
PLANT = SCENE.plant


@pytest.mark.parametrize("delay", [0.5, 1.0, 2.25])
def test_pieces_of_held_inputs(delay):
    made = StateAhead(PLANT, SCENE.dt, delay, 200, np.array([0.5]))
    given = [2.0, -3.0]
    for u in given:
        made.remember(np.array([u]))
    past = int(np.ceil(delay))
    held = [0.5, 0.5, *given][-past:]
    lengths = [SCENE.dt * (delay - (past - 1)), *[SCENE.dt] * (past - 1)]
    x = SCENE.initial[0]
    for u, h in zip(held, lengths):
        x = PLANT.simulate(x, np.tile([u], (2, 1)), np.array([0.0, h]), rtol=1e-11, atol=1e-13).x[-1]
    np.testing.assert_allclose(made(SCENE.initial[0]), x, rtol=1e-6, atol=1e-8)
    again = pickle.loads(pickle.dumps(made))
    np.testing.assert_array_equal(again(SCENE.initial[0]), made(SCENE.initial[0]))
    assert made.last().tolist() == [held[-1]]
    made.reset()
    assert made.last().tolist() == [0.5]

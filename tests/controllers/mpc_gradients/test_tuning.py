"""Weights tuned by gradients of the closed loop: the gradient against differences, and that costs fall."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import DifferentiableMPC, tune_mpc
from pliant.controllers.mpc_gradients.tuning import ClosedLoop
from pliant.envs import scenes

SLEW = scenes.get("single-link-slew")


def test_gradient_of_the_closed_loop_against_differences():
    """Off the limits: a start nearer to the goal, other machines, all weights; 1e-5 is asked."""
    near = dataclasses.replace(SLEW, duration=1.0, goal=(("hub_angle", 0.3),))
    loop = ClosedLoop(near, np.array([[1.0, 1.0, 1.0], [0.8, 1.1, 1.2]]), tuple(near.plant.uncertain))
    law = DifferentiableMPC.for_scene(near)
    _, slopes = loop.cost(law)
    own = {**law.Q, **law.R}
    for slope, name in zip(slopes, law.names):
        costs = [loop.cost(law.with_weights({name: own[name] * np.exp(h)}))[0] for h in (1e-3, -1e-3)]
        assert own[name] * slope == pytest.approx((costs[0] - costs[1]) / 2e-3, rel=1e-5, abs=1e-9)


def test_the_cost_falls():
    short = dataclasses.replace(SLEW, duration=1.0)
    found = tune_mpc(short, ranges={"payload.mass": (0.5, 2.0)}, runs=2, steps=6, rate=0.3)
    assert len(found.costs) == 7 and found.gain < 1 and found.costs.min() < found.costs[0]
    assert found.machines.shape == (2, 1) and set(found.weights) == {*dict(SLEW.weights), *dict(SLEW.effort)}


@pytest.mark.campaign
def test_machines_that_were_not_drawn_gain_too():
    from pliant.studies.closed_loop.rollout import randomised, rollout
    from pliant.studies.scoreboard.tasks import played_scene

    scene = scenes.get("two-link-reach")
    found = tune_mpc(scene, steps=30, rate=0.2)
    played = played_scene(scene, "varied")[0]
    costs = [
        np.mean([rollout(played, law, given).cost for given in randomised(played, 64)])
        for law in (DifferentiableMPC.for_scene(scene).law, found.law)
    ]
    assert costs[1] < 0.96 * costs[0]


def test_bad_input():
    for field, value in (("runs", 0), ("steps", -1), ("rate", 0.0), ("horizon", 0), ("seed", -1)):
        with pytest.raises(ValueError, match=rf"tune_mpc\.{field}"):
            tune_mpc(SLEW, **{field: value})
    with pytest.raises(ValueError, match=r"tune_mpc\.ranges"):
        tune_mpc(SLEW, ranges={"link.E": (2.0, 1.0)})

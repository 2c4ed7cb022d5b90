"""The cost-to-go at a horizon's end, the substeps of its prediction, and the horizon that does without."""

import numpy as np
import pytest

from pliant.controllers import NMPC, Objective
from pliant.controllers.nmpc.terminal_cost import fewest_substeps, regulator, wanted_horizon
from pliant.envs import scenes
from pliant.plants import EquilibriumError
from pliant.plants.integration.step_maps import step_limit

REACH, SLEW = scenes.get("two-link-reach"), scenes.get("single-link-slew")


def test_substeps_are_the_fewest_that_are_stable_and_fine_enough(cart):
    for scene, expected in ((REACH, 2), (SLEW, 3)):
        objective, start = Objective.of(scene), scene.initial[0]
        n = fewest_substeps(objective, start)
        assert n == expected
        assert scene.dt / (n - 1) > 0.9 * step_limit(scene.plant, objective.x_goal, u=objective.u_goal)
        e = start - objective.x_goal
        assert e @ regulator(objective, n).P @ e == pytest.approx(e @ regulator(objective, 32).P @ e, rel=0.01)
    slow, start = cart(dt=0.7), np.array([0.0, 1.0, 0.0, 0.0])
    assert fewest_substeps(slow) == 1 and fewest_substeps(slow, start) > 1  # stable, but not fine enough from there


def test_states_that_no_cost_sees_are_left_out_of_the_terminal_cost():
    scene = scenes.get("spin-up")
    nmpc = NMPC.for_scene(scene)
    k = nmpc.reads.index("hub_angle")
    assert not nmpc.horizon.P[k].any() and nmpc.horizon.P.any() and not nmpc.law.K[:, k].any()


@pytest.mark.campaign
def test_a_goal_that_is_not_at_rest_has_no_regulator():
    scene = scenes.get("slider-crank-run")
    with pytest.raises(EquilibriumError, match="crank_angle changes by"):
        NMPC.for_scene(scene)
    nmpc = NMPC.for_scene(scene, terminal=None, horizon=5)
    assert (np.abs(nmpc.act(0.0, scene.initial[0])) <= scene.limits).all()


def test_wanted_horizon_is_of_the_slowest_closed_loop_motion(cart):
    objective = cart()
    found = regulator(objective, 1)
    slowest = np.abs(found.poles).max()
    steps = wanted_horizon(found, objective.dt) / objective.dt
    assert slowest ** (2 * steps) == pytest.approx(0.02, rel=1e-6)

"""Objective: the scene's own cost, at rest and about goals that move; planning and prediction charge it at their times.

Reference: Scene.stage_cost, which this folder does not share code with, and the linear-quadratic optimum about a cart
that is to roll on at a constant speed: in coordinates that move with it, that is the regulator about rest.
"""

import dataclasses
import pickle

import numpy as np
import pytest

from pliant.controllers import NMPC, TVLQR, Objective, optimal
from pliant.envs import scenes
from pliant.plants import Trajectory
from pliant.plants.core.errors import EquilibriumError

SPEED = 0.5  # [m/s] of the goal


@pytest.mark.parametrize("name", ["spacecraft-orbit", "two-link-reach"])
def test_rate_is_the_scenes_own_at_every_time(name):
    scene = scenes.get(name)
    rng, plant, times = np.random.default_rng(0), scene.plant, np.array([0.0, 0.7, 3.0, 250.0])
    x = scene.target[0] + 1e-2 * rng.standard_normal((4, plant.nx))
    u = 1e-2 * rng.standard_normal((4, plant.nu))
    about = Objective.of(scene)
    np.testing.assert_allclose(
        about.rate(x, u, times), scene.stage_cost(x, u, plant.measure(x, u), times), rtol=1e-9, atol=1e-15
    )
    goal = about.goal_at(250.0)
    assert about.rate(goal, about.u_goal, 250.0) < 1e-15
    late = sum(w * (250.0 * dict(scene.goal_rates).get(n, 0.0)) ** 2 for n, w in scene.weights)
    assert about.rate(goal, about.u_goal, 0.0) == pytest.approx(late, rel=1e-9, abs=1e-15)
    assert (late > 1e-3) == bool(scene.goal_rates)
    later = sum(about.rate(x[k], u[k], 30.0 + k * scene.dt) for k in range(4)) * scene.dt
    assert about.cost(x, u, 30.0) == pytest.approx(later, rel=1e-12)
    np.testing.assert_array_equal(about.goal_at(2.0), scene.target[0] + 2.0 * scene.drift)


@pytest.fixture
def rolling(cart):
    """The cart's objective whose goal rolls on: s = SPEED t, at no force."""
    rest = cart(weights={"s": 5.0, "q": 1.0, "s_rate": 0.3})
    return dataclasses.replace(rest, x_goal=np.array([0.0, 0.0, SPEED, 0.0]), goal_rates={"s": SPEED}), rest


def test_motions_about_a_rolling_goal_are_those_about_rest(rolling):
    moving, rest = rolling
    x0, N = np.array([0.4, 0.05, 0.1, 0.0]), 25
    P = np.diag([30.0, 2.0, 3.0, 1.0])
    still = optimal(rest, x0 - moving.x_goal, N, terminal=P)
    found = optimal(moving, x0, N, terminal=P)
    assert found.cost == pytest.approx(still.cost, rel=1e-9)
    np.testing.assert_allclose(found.u, still.u, atol=1e-7)
    np.testing.assert_allclose(found.x[-1], still.x[-1] + moving.goal_at(N * moving.dt), atol=1e-7)
    assert moving.cost(found.x, found.u) == pytest.approx(rest.cost(still.x, still.u), rel=1e-9)
    there = optimal(moving, x0, N, terminal="goal")
    np.testing.assert_allclose(there.x[-1], moving.goal_at(N * moving.dt), atol=1e-8)


@pytest.mark.parametrize("start", [0.0, 7.3])
def test_nmpc_about_a_rolling_goal_is_lqr_about_rest(rolling, start):
    moving, rest = rolling
    law, reference = NMPC(moving, 12, substeps=20), NMPC(rest, 12, substeps=20)
    away = np.array([0.2, -0.03, 0.1, 0.05])
    for k in range(4):  # at times that are not the plan's own zero
        t = start + k * moving.dt
        x = moving.goal_at(t) + away / (k + 1)
        np.testing.assert_allclose(law.act(t, x), -reference.law.K @ (away / (k + 1)), atol=1e-6)
    law.reset()
    found = law.iterate(moving.goal_at(start) + away, t=start)
    assert found.cost == pytest.approx(away @ reference.law.P @ away, rel=1e-6)


def test_a_goal_whose_motion_is_not_said_has_no_regulator(rolling):
    moving, _ = rolling
    with pytest.raises(EquilibriumError, match=r"s changes by 0.05.*goal_rates"):
        NMPC(dataclasses.replace(moving, goal_rates={}), 12, substeps=20)


@pytest.mark.parametrize(
    "wrong, said",
    [
        ({"weights": {}, "effort": {}}, "weights, effort are empty"),
        ({"bounds": {"mass": 1.0}}, r"bounds\['mass'\] = 1.0 must be a pair"),
        ({"bounds": {"mass": (1.0, 1.0)}}, "must be lowest < highest"),
        ({"goal_rates": {"mass": 1.0}}, "'mass' must be one of s, q"),
        ({"goal_rates": {"s": np.nan}}, r"goal_rates\['s'\] = nan must be a finite"),
    ],
)
def test_wrong_objectives_are_named(cart, wrong, said):
    with pytest.raises(ValueError, match=said):
        cart(**wrong)


def test_a_copy_is_the_same(rolling):
    moving, _ = rolling
    x, u = np.ones((3, 4)), np.ones((3, 1))
    assert pickle.loads(pickle.dumps(moving)).cost(x, u, 2.0) == moving.cost(x, u, 2.0)


def test_a_nominal_hands_over_to_a_goal_that_rolls_on(rolling):
    """TVLQR along the rolling goal itself is the regulator about it, before the end of the nominal and after it."""
    moving, rest = rolling
    plant, T = moving.plant, 10
    x = np.array([moving.goal_at(k * moving.dt) for k in range(T + 1)])
    nominal = Trajectory.from_arrays(moving.dt * np.arange(T + 1), x, np.zeros((T + 1, 1)), plant=plant)
    law = NMPC(rest, 5, substeps=20).law
    hold = law.K, x[-1], np.zeros(1)
    made = TVLQR.along(plant, nominal, *[moving.dt * m for m in rest.quadratic()], dt=moving.dt, end=law.P, hold=hold)
    made.drift = moving.drift
    away = np.array([0.2, -0.03, 0.1, 0.05])
    for t in (0.0, 0.5, 1.0, 1.7, 20.0):
        np.testing.assert_allclose(made.act(t, moving.goal_at(t) + away), -law.K @ away, rtol=1e-6)

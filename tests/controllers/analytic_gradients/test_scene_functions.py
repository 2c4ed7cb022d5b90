"""A scene's functions on a batch: against the scene's own, one point at a time, and differences."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.analytic_gradients.scene_functions import KNEE, PENALTY, SceneFunctions
from pliant.envs import scenes

SCENE = scenes.get("two-link-reach")
FUNCTIONS = SceneFunctions(SCENE)
RNG = np.random.default_rng(0)
X = SCENE.initial[0] + 0.05 * RNG.standard_normal((4, SCENE.plant.nx))
U = RNG.standard_normal((4, SCENE.plant.nu))
P = np.tile(SCENE.varied_plant.nominal_parameters, (4, 1))


def test_cost_and_observations_are_the_scenes() -> None:
    _, _, cost, near = FUNCTIONS.cost_slopes(X, U, P)
    seen = FUNCTIONS.observe(X, U, P)
    goal = SCENE.goal_values(SCENE.observe)
    for i in range(4):
        y = SCENE.plant.measure(X[i], U[i])
        assert cost[i] == pytest.approx(SCENE.dt * SCENE.stage_cost(X[i], U[i], y), rel=1e-12)
        np.testing.assert_allclose(seen[i], SCENE.signal_values(X[i], y, SCENE.observe) - goal, atol=1e-12)
    assert not near.any()


def test_slopes_are_those_of_differences() -> None:
    lx, lu, _, _ = FUNCTIONS.cost_slopes(X, U, P)
    C, D = FUNCTIONS.observation_slopes(X, U, P)
    h = 1e-6
    for j in range(SCENE.plant.nx):
        step = np.eye(SCENE.plant.nx)[j] * h
        ahead, behind = (FUNCTIONS.cost_slopes(X + s, U, P)[2] for s in (step, -step))
        np.testing.assert_allclose((ahead - behind) / (2 * h), lx[:, j], atol=1e-7)
        ahead, behind = (FUNCTIONS.observe(X + s, U, P) for s in (step, -step))
        np.testing.assert_allclose((ahead - behind) / (2 * h), C[:, :, j], atol=1e-7)
    for j in range(SCENE.plant.nu):
        step = np.eye(SCENE.plant.nu)[j] * h
        ahead, behind = (FUNCTIONS.cost_slopes(X, U + s, P)[2] for s in (step, -step))
        np.testing.assert_allclose((ahead - behind) / (2 * h), lu[:, j], atol=1e-7)
    assert not D.any()  # nothing observed here shows the input at once


def test_nearness_to_a_bound_costs() -> None:
    scene = dataclasses.replace(SCENE, bounds=(("theta1_rate", 2.0),))
    x = SCENE.initial[0].copy()
    x[[s.name for s in SCENE.plant.states].index("theta1_rate")] = -2.2
    _, _, _, near = SceneFunctions(scene).cost_slopes(x[None], U[:1], P[:1])
    x0, u0 = scene.initial
    rate = scene.stage_cost(x0, u0, scene.plant.measure(x0, u0))
    assert near[0] == pytest.approx(scene.dt * PENALTY * rate * (1.1 - KNEE) ** 2)

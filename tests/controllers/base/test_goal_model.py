"""The model about a goal: a hub that only has to spin needs no angle, a goal that moves is moved with."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.base.goal_model import goal_model, require_held
from pliant.envs import scenes
from pliant.plants import EquilibriumError, LinearModel


def test_what_nothing_depends_on_and_no_cost_sees_is_left_out():
    scene = scenes.get("spin-up")
    model, drift = goal_model(scene)
    whole = scene.plant.linearize(*scene.target)
    assert set(whole.state_names) - set(model.state_names) == {"hub_angle"} and not drift.any()
    kept = [whole.state_names.index(name) for name in model.state_names]
    np.testing.assert_array_equal(model.A, whole.A[np.ix_(kept, kept)])
    np.testing.assert_array_equal(model.C, whole.C[:, kept])
    weighed = dataclasses.replace(scene, weights=(*scene.weights, ("hub_angle", 1.0)))
    with pytest.raises(EquilibriumError, match="hub_angle changes by"):
        goal_model(weighed)


def test_a_goal_that_moves_is_no_drift_of_the_deviations():
    scene = scenes.get("spacecraft-orbit")
    model, drift = goal_model(scene)
    rates = dict(scene.goal_rates)
    assert {name: r for name, r in zip(model.state_names, drift) if r} == rates
    assert np.abs(model.f0).max() < 1e-4  # [1/s], of rates of 1.1e-3
    with pytest.raises(EquilibriumError) as caught:
        goal_model(dataclasses.replace(scene, goal_rates=()))
    assert caught.value.residual == pytest.approx(max(abs(r) for r in rates.values()), rel=1e-3)


def test_a_point_that_moves_on_is_refused():
    still = LinearModel.from_matrices([[0.0]], [[1.0]], states=["x"])
    require_held(still)
    with pytest.raises(EquilibriumError, match=r"x changes by 0\.3"):
        require_held(dataclasses.replace(still, f0=[0.3]))

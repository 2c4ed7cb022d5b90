"""Weights by name as matrices: a cost expanded by hand, and second differences of every scene's stage cost."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import Objective
from pliant.envs import scenes
from pliant.plants import LinearModel
from pliant.plants.linear.quadratic_cost import about_moving_goal, goal_drift, quadratic_cost, signal_rows

H = 1e-4
MODEL = LinearModel.from_matrices(
    [[0.0, 1.0], [-2.0, -3.0]],
    [[0.0], [1.0]],
    [[1.0, 2.0]],
    [[0.5]],
    states=["position", "speed"],
    inputs=["force"],
    outputs=["mixed"],
)


def test_by_hand():
    """4 (x + 2 v + u/2)^2 + 3 v^2 + 7 u^2 = 4 x^2 + 16 xv + 19 v^2 + 8 u^2 + 2 (2 xu + 4 vu)."""
    Q, R, N = quadratic_cost(MODEL, {"mixed": 4.0, "speed": 3.0}, {"force": 7.0})
    np.testing.assert_array_equal(Q, [[4.0, 8.0], [8.0, 19.0]])
    np.testing.assert_array_equal(R, [[8.0]])
    np.testing.assert_array_equal(N, [[2.0], [4.0]])
    assert [part.tolist() for part in quadratic_cost(MODEL, {}, {})] == [[[0.0] * 2] * 2, [[0.0]], [[0.0], [0.0]]]


@pytest.mark.parametrize(("weights", "effort"), [({"mixd": 1.0}, {}), ({}, {"mixed": 1.0})])
def test_names_that_there_are_not(weights, effort):
    with pytest.raises(ValueError, match=r"own weight 'mixd'|own input 'mixed'"):
        quadratic_cost(MODEL, weights, effort, weighed="own weight", priced="own input")


def test_rows_of_states_and_outputs():
    C, D, values = signal_rows(dataclasses.replace(MODEL, y0=[9.0], x0=[5.0, 6.0]), ("mixed", "speed"), "signal")
    assert C.tolist() == [[1.0, 2.0], [0.0, 1.0]] and D.tolist() == [[0.5], [0.0]] and values.tolist() == [9.0, 6.0]


def test_deviations_from_a_goal_that_moves():
    """A goal at a constant speed of 0.3: nothing is left of dx/dt = 0.3; rates of others do not count."""
    rolling = dataclasses.replace(MODEL, f0=[0.3, 0.0])
    assert goal_drift(MODEL, {"position": 0.3, "elsewhere": 1.0}).tolist() == [0.3, 0.0]
    assert about_moving_goal(rolling, {"position": 0.3}).f0.tolist() == [0.0, 0.0]
    assert about_moving_goal(rolling, {}) is rolling


def curves(scene):
    """dx (n, nx): first derivatives of states whose signals move along each coordinate of the feedback model alone."""
    plant, slopes = scene.plant, scene.plant.jacobians(*scene.target)
    known = [s.name for s in plant.states]
    rows = np.vstack([np.eye(plant.nx), slopes[3]])
    names = known + [s.name for s in plant.outputs]
    wanted = rows[[names.index(name) for name in scene.feedback_model.state_names]]
    free = [i for i, name in enumerate(known) if not name.startswith("quaternion")]
    for i, name in enumerate(known):
        if name.startswith("quaternion") and "attitude_x" not in scene.feedback_model.state_names:
            wanted = np.vstack([wanted, rows[i]])  # an attitude that is left out stays
    assert np.linalg.matrix_rank(wanted) == len(wanted) and set(free) <= set(range(plant.nx))
    return np.linalg.pinv(wanted)[:, : len(scene.feedback_model.states)].T


def differences(scene):
    """[[Q, N], [N', R]] of the stage cost by central second differences."""
    plant, (x0, u0) = scene.plant, scene.target
    dx = curves(scene)
    n, nu = len(dx), plant.nu
    wide = np.zeros((n + nu, plant.nx + nu))
    wide[:n, : plant.nx], wide[n:, plant.nx :] = dx, np.eye(nu)

    def cost(d):
        x, u = plant.consistent(x0 + d[: plant.nx]), u0 + d[plant.nx :]
        return float(scene.stage_cost(x, u, plant.measure(x, u)))

    def second(d, h):
        return (cost(h * d) - 2 * cost(0 * d) + cost(-h * d)) / (2 * h**2)

    def along(d):
        return (4 * second(d, H / 2) - second(d, H)) / 3  # Richardson: the error is of fourth order

    own = np.array([along(d) for d in wide])
    found = np.diag(own)
    for i in range(n + nu):
        for j in range(i):
            found[i, j] = found[j, i] = (along(wide[i] + wide[j]) - own[i] - own[j]) / 2
    return found


SLOW = ("satellite-arm", "six-axis-pick")


def weighed(scene):
    """The scene as it is, and with each output that depends on an input at once weighed too."""
    yield scene
    for signal, row in zip(scene.feedback_model.outputs, scene.feedback_model.D):
        if row.any() and signal.name not in dict(scene.weights):
            yield dataclasses.replace(scene, weights=(*scene.weights, (signal.name, 1e-2)))


@pytest.mark.every(3)
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.campaign) if n in SLOW else n for n in scenes.names()]
)
def test_scene_is_charged_so_to_second_order(name):
    for scene in weighed(scenes.get(name)):
        Q, R, N = scene.quadratic()
        found, said = differences(scene), str(scene.weights[-1])
        np.testing.assert_allclose(
            np.block([[Q, N], [N.T, R]]), found, rtol=0, atol=1e-6 * np.abs(found).max(), err_msg=said
        )
    if any(d.any() for d in scene.feedback_model.D[[s.name in scene.weighted for s in scene.feedback_model.outputs]]):
        assert N.any()


def test_some_scenes_have_outputs_with_feedthrough():
    assert sum(len(list(weighed(scenes.get(name)))) - 1 for name in ("single-link-slew", "slider-crank-run")) >= 2


@pytest.mark.parametrize("name", ["tip_x", "tip_y"])
def test_outputs_that_a_moving_goal_takes_along_are_refused(name):
    """tip_x too, whose slope is zero where the goal begins; tip_deflection stays where it is."""
    slew = scenes.get("single-link-slew", goal=(("hub_angle", 0.0),))
    turning = dataclasses.replace(slew, goal_rates=(("hub_angle", 0.1),), weights=((name, 1.0), ("hub_angle", 1.0)))
    with pytest.raises(ValueError, match=f"scene 'single-link-slew': goal_rates move {name} too"):
        turning.goal_drift(turning.weighted)
    with pytest.raises(ValueError, match=f"Objective: goal_rates move {name} too"):
        _ = Objective.of(turning).residual_expression
    held = dataclasses.replace(turning, weights=(("tip_deflection", 1.0), ("hub_angle", 1.0)))
    np.testing.assert_array_equal(held.goal_drift(held.weighted), [0.0, 0.1])
    assert Objective.of(held).residual_expression.shape[0] == 3

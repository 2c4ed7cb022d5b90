"""Corners of what is not known, and what a model does not foretell there: other linear models, run-aways."""

import numpy as np
import pytest

from pliant.controllers import LQR, MPC, Feedback
from pliant.controllers.linear_quadratic.delay import delayed
from pliant.controllers.tube_mpc.corner_runs import GROWN, corners_of, points_of, unforetold
from pliant.controllers.tube_mpc.error_bounds import Course
from pliant.envs import scenes
from pliant.plants import PliantError

SCENE = scenes.get("single-link-slew")
MODEL = SCENE.plant.feedback_model(*SCENE.target)
HELD = MODEL.discretize(SCENE.dt)
ORIGIN = (MODEL.x0[None], MODEL.u0[None])
NOTHING = np.zeros((1, SCENE.plant.nx))


def course():
    rows, gain = np.zeros((1, 0, SCENE.plant.nx)), np.zeros((1, 1, SCENE.plant.nx))
    return Course(HELD.A[None], HELD.B[None], rows, np.zeros((1, 0, 1)), gain, gain)


def test_corners_are_all_of_starts_and_ranges_the_scene_as_it_is_first():
    found = corners_of(SCENE, {"payload.mass": (0.7, 1.3), "link.E": (0.9, 1.1)})
    assert len(found.x) == 1 + 2**3
    np.testing.assert_array_equal(found.x[0], SCENE.initial[0])
    np.testing.assert_allclose(sorted(set(found.x[1:, 0].round(12))), [-0.1, 0.1])
    own = found.plant.nominal_parameters
    assert {tuple(row) for row in (found.p[1:] / own).round(12)} == {(a, b) for a in (0.7, 1.3) for b in (0.9, 1.1)}


def test_of_too_many_some_are_drawn_each_with_its_opposite():
    many = scenes.get("two-link-reach")
    found = corners_of(many, dict.fromkeys([*many.plant.uncertain, "link1.density", "link2.density"], (0.5, 1.5)))
    assert len(found.x) == 145
    factors = found.p[1:] / found.plant.nominal_parameters
    np.testing.assert_allclose(factors[:72] + factors[72:], 2.0)


def test_what_a_corner_does_beside_the_model_is_what_its_own_linear_model_does():
    """(A_i - A) z + (B_i - B) u about the goal, with a heavier payload; the plant turns slowly and is nearly linear."""
    law = LQR.for_scene(SCENE, effort=1000.0)
    corners = corners_of(SCENE, {"payload.mass": (0.7, 1.3)})
    found = unforetold(SCENE, corners, law, course(), ORIGIN, NOTHING)
    assert found.shape == (SCENE.steps, 5, SCENE.plant.nx)
    lane = int(np.argmax(corners.p[:, 0]))
    heavy = corners.plant.feedback_model(*SCENE.target, p=corners.p[lane]).discretize(SCENE.dt)
    x, asked = corners.x[lane] - MODEL.x0, []
    for _ in range(20):
        u = -law.K @ x
        asked.append((heavy.A - HELD.A) @ x + (heavy.B - HELD.B) @ u)
        x = heavy.A @ x + heavy.B @ u
    size = np.abs(asked).max(axis=0)
    assert (np.abs(found[:20, lane] - asked) <= 0.02 * size).all()
    assert (np.abs(found[:, 0]).max(axis=0) <= 0.02 * size).all()  # as it is: the nonlinear rest alone


def test_of_inputs_on_their_way_the_model_foretells_what_acts():
    """(A_i - A) x + (B_i - B) u of the input that acts, asked for two periods ago by u = -K [x; those on their way]."""
    given = {"Q": dict(SCENE.weights), "R": {"hub_torque": 2.0}, "dt": SCENE.dt, "delay": 2}  # slow: nearly linear
    law, told = MPC.design(MODEL, horizon=1, **given), LQR.design(MODEL, **given)
    gain = np.hstack([told.K, told.K_past])
    late = delayed(HELD, 2)
    origin = (late.x0[None], late.u0[None])
    own = course()._replace(A=late.A[None], B=late.B[None])
    corners = corners_of(SCENE, {"payload.mass": (0.9, 1.1)})
    found = unforetold(SCENE, corners, law, own, origin, np.zeros((1, len(late.x0))))
    assert found.shape == (SCENE.steps, 5, SCENE.plant.nx)
    lane = int(np.argmax(corners.p[:, 0]))
    heavy = delayed(corners.plant.feedback_model(*SCENE.target, p=corners.p[lane]).discretize(SCENE.dt), 2)
    x, asked = np.append(corners.x[lane], [0.0, 0.0]) - late.x0, []
    for _ in range(20):
        asked.append((heavy.A - late.A) @ x)
        x = (heavy.A - heavy.B @ gain) @ x
    size = np.abs(asked).max(axis=0)[: SCENE.plant.nx]
    assert (np.abs(found[:20, lane] - np.array(asked)[:, : SCENE.plant.nx]) <= 0.03 * size).all()  # RK4's is 0.024


def test_each_period_has_its_neighbours():
    w = np.arange(6.0).reshape(3, 2, 1)
    np.testing.assert_allclose(np.sort(points_of(w)[0, :, 0]), GROWN * np.array([0, 0, 1, 1, 2, 3]))
    np.testing.assert_allclose(np.sort(points_of(w)[1, :, 0]), GROWN * np.arange(6.0))


def test_a_corner_that_runs_away_is_told():
    away = Feedback(-1e6 * np.ones((1, SCENE.plant.nx)), MODEL.state_names, dt=SCENE.dt)
    with pytest.raises(PliantError, match=r"a corner of what is uncertain runs away at"):
        unforetold(SCENE, corners_of(SCENE, {}), away, course(), ORIGIN, NOTHING)

"""Models of a box: their delay against the one of `delayed`, their corners, what is read."""

import numpy as np
import pytest

from pliant.controllers import delayed, sensors_of
from pliant.controllers.robust_design.box_models import away, corners, known_of, models_over
from pliant.envs import scenes
from pliant.plants import PliantError

SLEW = scenes.get("single-link-slew")
OWN = ((SLEW.plant, SLEW.target),)


def test_corners_of_a_box_and_its_middle():
    found = np.array(corners({"a": (0.5, 2.0), "b": (0.7, 1.3)}))
    assert found.tolist() == [[1, 1], [0.5, 0.7], [0.5, 1.3], [2, 0.7], [2, 1.3]]
    many = np.array(corners({f"p{k}": (0.5, 2.0) for k in range(9)}))
    assert many.shape == (33, 9) and set(many[1:].ravel()) == {0.5, 2.0}


def test_a_late_model_is_the_delayed_one_with_its_inputs_newest_first():
    known = known_of(SLEW, None, 2)
    for delay in (1, 2):
        models = models_over(SLEW, OWN, {}, (delay,), known)
        late = delayed(SLEW.plant.feedback_model(*SLEW.target).discretize(SLEW.dt), delay)
        ours, theirs = (np.linalg.eigvals(A) for A in (models.A[0], late.A))
        assert np.sort(np.abs(ours[np.abs(ours) > 1e-6])) == pytest.approx(
            np.sort(np.abs(theirs[np.abs(theirs) > 1e-6]))
        )
        z = np.zeros(models.A.shape[1])
        x = z + models.B[0][:, 0]  # an impulse now
        y = np.zeros(len(late.states)) + late.B[:, 0]
        for _ in range(6):
            x, y = models.A[0] @ x, late.A @ y
            np.testing.assert_allclose(x[: SLEW.plant.nx], y[: SLEW.plant.nx], atol=1e-12)


def test_parameters_and_start_are_the_scenes():
    known = known_of(SLEW, None, 1)
    models = models_over(SLEW, OWN, {"payload.mass": (0.5, 2.0)}, (0,), known)
    heavy = SLEW.plant.vary("payload.mass").linearize(*SLEW.target, p=[2.0]).discretize(SLEW.dt)
    np.testing.assert_allclose(models.A[2][: SLEW.plant.nx, : SLEW.plant.nx], heavy.A, atol=1e-12)
    model = SLEW.plant.feedback_model(*SLEW.target)
    np.testing.assert_allclose(away(SLEW, model), SLEW.initial[0] - SLEW.target[0])


def test_sensors_with_feedthrough_of_an_input_are_left_out():
    reach = scenes.get("two-link-reach")
    known = known_of(reach, sensors_of(reach.plant), 1)
    assert known.reads == ("theta1", "theta2", "root1_curvature", "root2_curvature")  # no accelerometer
    assert (known.deviation > 0).all() and (known.size > 0).all()


def test_a_goal_that_moves_is_refused():
    with pytest.raises(PliantError, match="goal"):
        known_of(scenes.get("slider-crank-run"), None, 1)

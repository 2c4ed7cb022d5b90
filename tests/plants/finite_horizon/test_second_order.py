"""What the linear model leaves out, against the plant's own motion under the disturbance that pushes it most."""

import dataclasses

import numpy as np
import pytest
from horizon_models import constant

from pliant.envs import scenes
from pliant.plants.finite_horizon import finite_horizon
from pliant.plants.finite_horizon.second_order import beyond_linear, left_out, pushed, turned

SLEW = scenes.get("single-link-slew")
U = np.array([SLEW.nominal_input(s) for s in SLEW.times])
MOTION = SLEW.plant.simulate(SLEW.nominal_initial[0], U, SLEW.times, rtol=1e-10, atol=1e-12)
ALONG = SLEW.plant.linearize_along(MOTION)


def asked(limit):
    return finite_horizon(ALONG, outputs=["tip_y"], disturbances=["tip_force_y"], limits={"tip_force_y": limit})


def test_it_is_what_the_plant_adds_to_second_order():
    """The arm itself plays the torque (DOP853): its motion less the model's is what was told."""
    torque = SLEW.plant.inputs
    found = finite_horizon(ALONG, outputs=["tip_y"], disturbances=[torque[0].name], limits={torque[0].name: 0.02})
    off = pushed(ALONG, found.t, torque, found.bounded["tip_y"].disturbance)
    played = SLEW.plant.simulate(MOTION.x[0], U + off[1], MOTION.t, rtol=1e-10, atol=1e-12)
    k = ALONG.output_names.index("tip_y")
    linear = (ALONG.C @ off[0][..., None])[:, k, 0]
    true = float(np.abs(played["tip_y"] - MOTION["tip_y"] - linear).max())
    assert found.left_out["bounded"] == pytest.approx(true, rel=1e-3) and true > 1e-4


def test_it_falls_with_the_square_and_is_told_where_it_is_not_small():
    """A newton turns the arm by 80 degrees, a hundredth of one by none."""
    small, large = asked(1e-3), asked(1.0)
    assert small.left_out["bounded"] == pytest.approx(asked(2e-3).left_out["bounded"] / 4, rel=0.02)
    assert "beyond where the linear model can be trusted: what it leaves out is, to second order, about" in large.words
    assert "both lie" in large.words and "the last" not in large.words
    first = small.words
    assert "(the first lies beyond where" in first and "about" in first  # unit energy is as much as before
    assert (
        "trusted"
        not in finite_horizon(
            ALONG,
            outputs=["tip_y"],
            scale={"tip_force_y": 1e-3},
            disturbances=["tip_force_y"],
            limits={"tip_force_y": 1e-3},
        ).words
    )


def test_of_a_model_whose_plant_is_not_known_angles_tell():
    """dphi/dt = w for 2 s, |w| <= 1: 2 rad; of a model that was changed nothing of the plant is said."""
    model = constant([[0.0]], [[1.0]], [[1.0]], 2.0)
    turning = dataclasses.replace(model, states=(dataclasses.replace(model.states[0], unit="rad"),))
    told = finite_horizon(turning)
    assert (
        told.left_out is None
        and "(both lie beyond where the linear model can be trusted: in it x1 turns by" in told.words
    )
    assert told.words.endswith("x1 turns by 2 rad)") and "trusted" not in finite_horizon(model).words
    assert turned(model, np.ones((201, 1))) == ("", 0.0)
    other = dataclasses.replace(ALONG, A=ALONG.A * 1.001)
    assert (
        left_out(other, pushed(other, other.t, other.disturbances, np.zeros((len(other.t), 2))), np.array([0])) is None
    )


def test_a_state_that_the_plant_does_not_have_is_more_than_can_be_told():
    def none(*_):
        raise ValueError("no such state")

    lost, found = dataclasses.replace(ALONG, missed=none), asked(1.0)
    _, words = beyond_linear(lost, found.t, found.disturbances, found.furthest, {"bounded": found.bounded["tip_y"]})
    assert words.startswith(" (it lies beyond where the linear model can be trusted: what it leaves out is, to second")
    assert words.endswith("order, more than can be told)")

"""What errors of parameters push, against sums over the motion, and filters that are told of it."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.controllers.estimation import parameter_noise
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.process_noise import process_noise
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")
PLAIN, K = Kalman.for_scene(SCENE), LQR.for_scene(SCENE).K
MODEL = PLAIN.model


def test_the_motion_is_that_of_the_sampled_linear_loop():
    found = parameter_noise.linear_motion(SCENE, MODEL, K)
    held, nx = MODEL.discretize(SCENE.dt), len(MODEL.states)
    start = SCENE.initial[0] - SCENE.target[0]
    want = np.linalg.matrix_power(held.A - held.B @ K, 20) @ start
    np.testing.assert_allclose(found[:nx, 20], want, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found[nx:-1, 20], -K @ want, rtol=1e-9, atol=1e-12)
    assert (found[-1] == 1.0).all() and found.shape[1] == SCENE.steps


def test_the_covariance_is_the_mean_over_the_motion_of_what_the_error_moves():
    """An error uniform within +-s has variance s^2 / 3; what it moves is the difference of both plants' rates."""
    box = {"link.damping": (0.8, 1.2)}
    (root,) = parameter_noise.pushed(SCENE, MODEL, box, K)
    link = dataclasses.replace(SCENE.plant.link, damping=1.2 * SCENE.plant.link.damping)
    other = dataclasses.replace(SCENE.plant, link=link).feedback_model(*SCENE.target)
    nx, total = len(MODEL.states), np.zeros((len(root), len(root)))
    for row in parameter_noise.linear_motion(SCENE, MODEL, K).T:
        x, u = row[:nx], row[nx:-1]
        rates = (other.A - MODEL.A) @ x + (other.B - MODEL.B) @ u + other.f0 - MODEL.f0
        reads = (other.C - MODEL.C) @ x + (other.D - MODEL.D) @ u + other.y0 - MODEL.y0
        total += np.outer(both := np.concatenate([rates, reads]), both) / (3 * SCENE.steps)
    np.testing.assert_allclose(root @ root.T, total, atol=1e-5 * np.abs(total).max())


def test_a_filter_that_is_told_of_nothing_is_the_plain_one():
    W, nothing = process_noise(SCENE), np.zeros((len(MODEL.states) + len(MODEL.outputs), 1))
    found = parameter_noise.told_parameters(PLAIN, PLAIN.sensors, [nothing], W, "white", SCENE.dt)
    plain = Kalman.design(MODEL, PLAIN.sensors, W, dt=SCENE.dt)
    np.testing.assert_allclose(found.gains[-1].L, plain.gains[-1].L, rtol=1e-7, atol=1e-9)
    assert found.model is MODEL and found.sensors == PLAIN.sensors
    np.testing.assert_array_equal(found.start, PLAIN.start)


def test_readings_are_off_by_a_share_of_their_range():
    motion = parameter_noise.linear_motion(SCENE, MODEL, K)
    wide = parameter_noise.off_by(PLAIN.sensors, MODEL, motion, 0.01)
    angle = next(k for k, s in enumerate(PLAIN.sensors) if s.output == "hub_angle")
    spread = np.ptp(motion[0])  # the hub angle is the first state
    assert wide[angle].noise == pytest.approx(np.hypot(PLAIN.sensors[angle].noise, 0.01 * spread))
    assert parameter_noise.off_by(PLAIN.sensors, MODEL, motion, 0.0) == PLAIN.sensors


def test_the_box_has_what_the_plant_calls_uncertain_and_is_not_zero():
    found = parameter_noise.uncertain_box(SCENE, 0.1)
    assert set(found) <= set(SCENE.plant.uncertain) and set(found.values()) == {(0.9, 1.1)}
    still = dataclasses.replace(SCENE.plant, payload=dataclasses.replace(SCENE.plant.payload, mass=0.0))
    less = parameter_noise.uncertain_box(dataclasses.replace(SCENE, plant=still), 0.1)
    assert set(found) - set(less) == {"payload.mass"}

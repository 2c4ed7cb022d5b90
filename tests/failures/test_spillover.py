"""Spillover: an LQR sampled fast, with effort too cheap for its two modes a link, drives a mode it does not know."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import IntegrationError, MassMatrixError
from pliant.studies.closed_loop.closed_loop import closed_loop, dearer, regulator

SCENE = scenes.get("two-link-reach")
CHEAP = dataclasses.replace(
    SCENE, duration=0.5, dt=0.005, effort=tuple((name, weight / 100) for name, weight in SCENE.effort)
)


@pytest.fixture(scope="module")
def loops():
    """Of the scene's own weights, on all plants."""
    return closed_loop(dataclasses.replace(SCENE, duration=0.5))[1]


def disturbed_rest(scene, plant) -> float:
    """How far theta1 [rad] still swings in the last half second, from 1 mrad off the goal, under the scene's LQR."""
    x, _ = scene.with_plant(plant).target
    start = x.copy()
    start[0] += 1e-3
    motion = plant.simulate(start, regulator(scene), np.arange(0.0, 3.0001, scene.dt), rtol=1e-5, atol=1e-7)
    return float(np.ptp(motion["theta1"][motion.t > 2.5]))


def test_the_naive_weights_hold_the_design_model_and_shake_the_finer_one() -> None:
    assert disturbed_rest(CHEAP, CHEAP.plant) < 1e-4
    try:
        shaken = disturbed_rest(CHEAP, dearer(CHEAP.plant))
    except (IntegrationError, MassMatrixError):
        return
    assert shaken > 1e-2


def test_it_is_noticed_and_named_before_any_simulation() -> None:
    _, loops = closed_loop(CHEAP)
    finer = loops[-1]
    assert finer.stable is False and finer.spillover
    assert "spillover" in finer.verdict and "Hz" in finer.verdict


def test_the_scenes_own_weights_hold_both(loops) -> None:
    assert disturbed_rest(SCENE, SCENE.plant) < 1e-4
    assert disturbed_rest(SCENE, dearer(SCENE.plant)) < 1e-4
    assert all(loop.stable for loop in loops)


@pytest.mark.parametrize("mass", [0.5, 1.5])
def test_payload_half_as_light_and_half_as_heavy_stay_at_rest(loops, mass: float) -> None:
    payload = dataclasses.replace(SCENE.plant.payload, mass=mass * SCENE.plant.payload.mass)
    assert all(loop.stable for loop in loops if "payload" in loop.name)
    plant = dataclasses.replace(SCENE.plant, payload=payload)
    motion = plant.simulate(SCENE.target[0], regulator(SCENE), np.arange(0.0, 4.0001, SCENE.dt), rtol=1e-5, atol=1e-7)
    assert np.ptp(motion["theta1"][-25:]) < 1e-3  # at rest, somewhat off the goal: gravity has changed

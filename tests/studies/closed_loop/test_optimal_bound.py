"""The bound: the finite-horizon Riccati cost where all is linear; what a delay charges."""

import dataclasses

import numpy as np
import pytest
import scipy.linalg as sla

from pliant.envs import scenes
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.optimal_bound import bound
from pliant.studies.closed_loop.rollout import nominal

SLEW = scenes.get("single-link-slew")


def test_bound_of_a_linear_plant_is_the_finite_horizon_riccati_cost():
    """P_N = 0, P_k = Q dt + A'P A - A'P B (R dt + B'P B)^-1 B'P A; no limit is active from 0.1 rad."""
    plant = dataclasses.replace(SLEW.plant, kinematics="linear")
    scene = play(dataclasses.replace(SLEW, plant=plant, start=(("hub_angle", 0.9),), duration=1.0))
    model = plant.linearize(*scene.target)
    big = sla.expm(np.block([[model.A, model.B], [np.zeros((1, 7))]]) * scene.dt)
    A, B = big[:6, :6], big[:6, 6:]
    Q, R, _ = scene.quadratic()
    P = np.zeros((6, 6))
    for _ in range(scene.steps):
        P = scene.dt * Q + A.T @ P @ (A - B @ np.linalg.solve(scene.dt * R + B.T @ P @ B, B.T @ P @ A))
    off = scene.initial[0] - scene.target[0]
    cost, x, u = bound(scene, nominal(scene))
    assert np.abs(u).max() < 40 and x.shape == (51, 6)
    assert cost == pytest.approx(off @ P @ off, rel=1e-4)  # the plant still turns: cos(hub_angle) enters no cost


def test_bound_with_delay_charges_what_happens_before():
    scene = play(SLEW)
    late = dataclasses.replace(nominal(scene), delay=3)
    cost, x, u = bound(scene, late)
    assert len(x) == len(u) + 1 == SLEW.steps + 1 and (u[:3] == 0).all() and np.abs(x[3]).max() < 1e-12
    free = dataclasses.replace(scene, duration=SLEW.duration - 3 * SLEW.dt)
    assert cost == pytest.approx(3 * SLEW.dt * 10.0 + bound(free, nominal(free))[0], rel=1e-6)  # 10 (1 rad)^2 a second

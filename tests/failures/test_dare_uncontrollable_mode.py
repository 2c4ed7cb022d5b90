"""A spacecraft's torques do not reach the mode in which its panels shift the hub: without damping there is no DARE.

With equal panels on both sides that mode, 0.15 Hz, has no angular momentum. Undamped it stays on the unit circle
whatever the feedback, and the discrete Riccati equation has no stabilising solution.
"""

import dataclasses

import numpy as np
import pytest
from scipy.linalg import LinAlgError, solve_discrete_are

from pliant.controllers import LQR, riccati
from pliant.envs import scenes
from pliant.plants import UncontrollableError

SCENE = scenes.get("spacecraft-slew")


def craft(damping):
    panels = tuple(dataclasses.replace(panel, damping=damping) for panel in SCENE.plant.appendages)
    return SCENE.with_plant(dataclasses.replace(SCENE.plant, appendages=panels))


def problem(scene):
    model, (Q, R, _) = scene.feedback_model, scene.quadratic()
    return model, riccati.sampled(model.A, model.B, Q, R, dt=scene.dt)


def test_of_the_two_panel_modes_one_is_not_reached():
    # eta'' = -[[a, b], [b, a]] eta + g (1, 1)' torque_z: the modes are (1, 1) with a + b, and (1, -1) with a - b.
    model, _ = problem(craft(0.0))
    i, rates = [model.state_names.index(n) for n in ("eta1_1", "eta2_1")], ("eta1_1_rate", "eta2_1_rate")
    k = [model.state_names.index(n) for n in rates]
    (a, b), (c, d) = -model.A[np.ix_(k, i)]
    assert a == pytest.approx(d) and b == pytest.approx(c)
    np.testing.assert_allclose(model.B[k[0]], model.B[k[1]], atol=1e-15)
    assert np.sqrt([a - b, a + b]) / (2 * np.pi) == pytest.approx([0.152, 0.259], abs=1e-3)


def test_naive_scipy_returns_garbage_or_raises():
    _, (A, B, Q, R, N) = problem(craft(0.0))
    try:
        P = solve_discrete_are(A, B, Q, R, s=N)
    except LinAlgError:
        return
    K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + N.T)
    _, (*damped, s) = problem(craft(0.005))
    assert np.abs(P).max() > 1e3 * np.abs(solve_discrete_are(*damped, s=s)).max()
    assert np.abs(np.linalg.eigvals(A - B @ K)).max() > 1 - 1e-9  # it does not stabilise, and did not say so


def test_the_mode_is_named():
    scene = craft(0.0)
    model, (A, B, Q, R, N) = problem(scene)
    with pytest.raises(
        UncontrollableError, match=r"mode 0\.15 Hz \(eta\d_1\) cannot be reached by the input"
    ) as caught:
        riccati.dlqr(A, B, Q, R, N, names=model.state_names, dt=scene.dt)
    assert len(caught.value.modes) == 1
    with pytest.raises(UncontrollableError, match=r"mode 0\.15 Hz"):
        LQR.for_scene(scene)


def test_one_wheel_leaves_the_other_axes_too():
    scene = craft(0.0)
    model, (A, B, Q, _, N) = problem(scene)
    wheel = [model.input_names.index("torque_z")]
    with pytest.raises(UncontrollableError) as caught:
        riccati.dlqr(A, B[:, wheel], Q, np.eye(1), N[:, wheel] * 0, names=model.state_names, dt=scene.dt)
    assert {m for m in caught.value.modes if "0.15 Hz" in m} and {m for m in caught.value.modes if "attitude_x" in m}


def test_with_damping_the_design_goes_through_and_the_mode_decays_by_itself():
    scene = craft(0.005)
    law = LQR.for_scene(scene)
    slowest = law.poles[np.argmin(np.abs(np.abs(np.log(law.poles)) / scene.dt - 2 * np.pi * 0.152))]
    model, _ = problem(scene)
    own = np.linalg.eigvals(model.A)
    mine = own[np.argmin(np.abs(own - 2j * np.pi * 0.152))]
    assert np.abs(law.poles).max() < 1
    assert np.log(slowest).real / scene.dt == pytest.approx(mine.real, rel=1e-6)

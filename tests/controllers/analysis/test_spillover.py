"""Spillover against Routh's criterion of two masses, against theorems, and by the modes that it names."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR, MPC, Feedback
from pliant.controllers.analysis.linear_laws import linearised
from pliant.controllers.analysis.loops import closed_loop, loop
from pliant.controllers.analysis.spillover import NEAR, RESERVE, case_of, crossover_hz, growth, origin, spillover
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.sensors import sensors_of
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.envs import scenes
from pliant.plants import LinearModel, PliantError, SingleLinkArm

M1, M2, K, C = 1.0, 0.5, 400.0, 0.4
KP, KD = 8.0, 5.0
SIGNALS = {"states": ("x2", "v2"), "inputs": ("force",), "outputs": ("x2", "v2")}
RIGID = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [1 / (M1 + M2)]], np.eye(2), **SIGNALS)
TWO = LinearModel.from_matrices(
    [[0, 0, 1, 0], [0, 0, 0, 1], [-K / M1, K / M1, -C / M1, C / M1], [K / M2, -K / M2, C / M2, -C / M2]],
    [[0], [0], [1 / M1], [0]],
    [[0, 1, 0, 0], [0, 0, 0, 1]],
    **(SIGNALS | {"states": ("x1", "x_far", "v1", "v_far")}),
)
FAR_SIDE = Feedback([[KP, KD]], ("x2", "v2"))
NEAR_SIDE = Feedback([[KP, KD]], ("x1", "v1"))


def routh(g):
    """> 0 where m1 m2 s^4 + c M s^3 + (k M + c g kd) s^2 + (g (k kd + c kp)) s + g k kp has its roots to the left."""
    a4, a3, a2 = M1 * M2, C * (M1 + M2), K * (M1 + M2) + C * g * KD
    a1, a0 = g * (K * KD + C * KP), g * K * KP
    return a1 * (a3 * a2 - a4 * a1) - a3**2 * a0


def critical_gain():
    """The factor on the gain at which Routh's expression, a quadratic in it past g itself, changes sign."""
    at = np.array([1e-3, 0.5, 1.0])
    values = np.array([routh(g) / g for g in at])
    return np.sort(np.roots(np.polyfit(at, values, 2)))[-1]


def test_two_masses_pushed_by_what_the_far_one_does():
    """The design model holds however large the gain; the far mass grows past Routh's limit, found within 1 %."""
    assert routh(1.0) < 0
    report = spillover(FAR_SIDE, [RIGID, TWO], reserve=1.0)
    assert report.cases[0].stable and not report.cases[1].stable and not report.holds
    assert report.factor == pytest.approx(critical_gain(), rel=0.011) and report.factor < critical_gain()
    case = report.first
    assert case.number == 3 and case.lacking  # two rigid-body modes first
    assert case.frequency_hz == pytest.approx(np.sqrt(K * (1 / M1 + 1 / M2)) / (2 * np.pi), rel=1e-3)
    poly = [M1 * M2, C * (M1 + M2), K * (M1 + M2) + C * KD, K * KD + C * KP, K * KP]
    assert case.growth == pytest.approx(np.roots(poly).real.max(), rel=1e-9)
    assert "the design model has only 2" in report.verdict and "holds with gain times" in report.verdict
    held = spillover(FAR_SIDE, [RIGID, TWO])
    assert held.factor == pytest.approx(critical_gain() / 1.25, rel=0.011)


def test_bandwidth_is_where_the_loop_gain_is_one():
    """|kp + i w kd| = M w^2 on the rigid mass."""
    M = M1 + M2
    w = np.sqrt((KD**2 + np.sqrt(KD**4 + 4 * M**2 * KP**2)) / (2 * M**2))
    assert spillover(FAR_SIDE, [RIGID]).bandwidth_hz == pytest.approx(w / (2 * np.pi), rel=1e-4)
    assert crossover_hz(loop(RIGID, FAR_SIDE), 1e-9) < 1e-3


@pytest.mark.every(3)
@pytest.mark.parametrize("gain", [1.0, 1e2, 1e4])
def test_collocated_rate_feedback_never_spills_in_continuous_time(gain):
    """Damping at the motor takes energy from every mode (Aubrun 1980), so that no rung of the ladder grows."""
    arm = SingleLinkArm.textbook()
    ladder = [arm.ladder()[0], *(dataclasses.replace(arm, modes=n) for n in (1, 2, 4, 8))]
    law = Feedback([[5 * gain, gain]], ("hub_angle", "hub_angle_rate"))
    report = spillover(law, ladder, {"hub_angle": 0.3})
    assert report.holds and report.factor is None and report.first is None
    assert "holds on all 5 plants" in report.verdict


def test_sampling_makes_it_spill():
    """Less gain helps where the sampling is fast enough; a mode at 43 Hz sampled at 50 Hz looks like one at 7 Hz that
    turns backwards, so that rate feedback pushes it at any gain.
    """
    arm = SingleLinkArm.textbook()
    ladder = [arm.ladder()[0], dataclasses.replace(arm, modes=2)]
    held = {"hub_angle": 0.0}
    law = Feedback([[2000.0, 400.0]], ("hub_angle", "hub_angle_rate"), dt=0.01)
    report = spillover(law, ladder, held)
    assert report.cases[0].stable and not report.holds
    slower = dataclasses.replace(law, K=report.factor * law.K)
    assert spillover(slower, ladder, held).holds
    folded = spillover(dataclasses.replace(law, K=0.1 * law.K, dt=0.02), ladder, held)
    assert folded.first.dominant_state == "eta2" and 1 / 0.02 / 2 < folded.first.frequency_hz < 1 / 0.02
    assert folded.factor is None and "factors on the gain in each octave" in folded.verdict


def test_modes_are_followed_from_the_open_loop():
    """At gain 0 the loop has the plant's eigenvalues and the controller's own; a weak one keeps them apart."""
    scene = scenes.get("single-link-slew")
    model = scene.plant.linearize(*scene.target)
    kalman = Kalman.design(model, sensors_of(scene.plant), {"tip_force_y": 1e-2}, dt=0.005)
    lqg = LQG(LQR.design(model, dict(scene.weights), {"hub_torque": 1.0}, dt=0.005), kalman)
    A = closed_loop(model, lqg, 0.0)
    start = np.exp(model.eigenvalues * 0.005)
    values = np.linalg.eigvals(A)
    assert all(np.abs(values - z).min() < 1e-6 for z in start)
    wanted = model.eigenvalues[np.argmax(model.eigenvalues.imag)]
    full = np.linalg.eigvals(closed_loop(model, lqg))
    found, own = origin(model, lqg, full[np.argmin(np.abs(full - np.exp(wanted * 0.005)))])
    assert abs(found) == pytest.approx(abs(wanted), rel=0.05) and isinstance(own, bool)


def test_a_mode_that_moved_is_told_from_one_that_is_lacking():
    stiff = TWO
    soft = LinearModel.from_matrices(
        np.where(np.abs(TWO.A) == 1, TWO.A, 0.5 * TWO.A), TWO.B, TWO.C, **(SIGNALS | {"states": TWO.states})
    )
    case = case_of(soft, FAR_SIDE, stiff, "soft")
    assert not case.stable and not case.lacking
    assert case.design_hz == pytest.approx(np.sqrt(2) * case.frequency_hz, rel=1e-2)
    assert "the design model has it at" in case.mode


def test_redesign_and_what_cannot_be_helped():
    report = spillover(
        FAR_SIDE, [RIGID, TWO], redesign=lambda f: Feedback([[KP / f**2, KD / f]], ("x2", "v2")), reserve=1.0
    )
    assert report.by == "effort" and report.factor > 1 and growth(TWO, report.controller) < 0
    assert report.allowed_hz < report.bandwidth_hz and "holds with effort times" in report.verdict
    grows = LinearModel.from_matrices([[0, 1], [0, 3.0]], [[0], [0.01]], np.eye(2), **SIGNALS)
    lost = spillover(FAR_SIDE, [RIGID, grows])
    assert lost.factor is None and "factors on the gain in each octave" in lost.verdict


def test_laws_without_a_gain_are_linearised():
    """Predictive control inside its limits is the LQR of its weights; what has memory is refused."""
    scene = scenes.get("single-link-slew")
    model = scene.plant.linearize(*scene.target)
    weights, effort = dict(scene.weights), dict(scene.effort)
    mpc, lqr = MPC.design(model, weights, effort, dt=0.02), LQR.design(model, weights, effort, dt=0.02)
    law = linearised(mpc, model.x0)
    np.testing.assert_allclose(law.D, lqr.K, atol=1e-7 * np.abs(lqr.K).max())
    assert growth(model, law) == pytest.approx(np.log(np.abs(lqr.poles).max()) / 0.02, rel=1e-6)
    assert spillover(law, [model]).holds
    kalman = Kalman.design(model, sensors_of(scene.plant), {"tip_force_y": 1e-2}, dt=0.02)
    with pytest.raises(PliantError, match="acts differently on the same reading"):
        linearised(LQG(lqr, kalman), kalman.y0[0] + 1e-3)


def test_bad_input():
    with pytest.raises(ValueError, match="must hold the design plant"):
        spillover(FAR_SIDE, [])
    with pytest.raises(ValueError, match=r"reserve = 0\.5 must be at least 1"):
        spillover(FAR_SIDE, [RIGID], reserve=0.5)
    with pytest.raises(PliantError, match="has no linear form"):
        spillover(lambda t, y: y, [RIGID])


LAG = 0.4  # [s] each of two lags that the design model lacks
MOST_GAIN = 1 + (2 - LAG) * (1 - 2 * LAG) / LAG


def unstable_with_lags():
    """x' = x + b, b two lags of u: (s - 1)(LAG s + 1)^2 + k = 0 is stable where MOST_GAIN > k > 1 (Routh)."""
    design = LinearModel.from_matrices([[1.0]], [[1.0]], states=["a"])
    fine = LinearModel.from_matrices(
        [[1.0, 1, 0], [0, -1 / LAG, 1 / LAG], [0, 0, -1 / LAG]], [[0], [0], [1 / LAG]], states=["a", "b", "c"]
    )
    return design, fine


@pytest.mark.parametrize("gain", [3.0, 7.0, 40.0])
def test_a_window_of_gains_is_found(gain):
    """The largest gain that holds with its reserve, though half of it may not."""
    design, fine = unstable_with_lags()
    found = spillover(Feedback(np.array([[gain]]), ("a",)), [design, fine])
    assert not found.holds and found.factor is not None
    assert gain * found.factor == pytest.approx(MOST_GAIN / RESERVE, rel=NEAR)
    assert 1 < gain * found.factor <= MOST_GAIN / RESERVE


def test_where_no_factor_holds_it_is_said_which_were_tried():
    design, _ = unstable_with_lags()
    slow = LinearModel.from_matrices(  # no gain holds 1 / (s - 1) behind lags of a second
        [[1.0, 1, 0], [0, -1.0, 1.0], [0, 0, -1.0]], [[0], [0], [1.0]], states=["a", "b", "c"]
    )
    found = spillover(Feedback(np.array([[3.0]]), ("a",)), [design, slow])
    assert found.factor is None
    assert "of 24 factors on the gain in each octave up to 1e+09 none makes it hold" in found.verdict

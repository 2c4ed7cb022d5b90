"""Verdicts of models whose stability is known, and what is refused."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import TwoLinkArm
from pliant.plants.stability import METHODS, assess, growth


@pytest.mark.parametrize(
    ("A", "dt", "verdict", "margin"),
    [
        ([[0, 1], [-4, -0.4]], None, "stable", 0.2),
        ([[0, 1], [-4, 0.4]], None, "unstable", -0.2),
        ([[0, 1], [-4, 0]], None, "marginal", 0.0),
        ([[0, 1], [0, 0]], None, "marginal", 0.0),
        ([[0.5, 0], [0, -0.9]], 0.1, "stable", -np.log(0.9) / 0.1),
        ([[1.1, 0], [0, 0.2]], 0.1, "unstable", -np.log(1.1) / 0.1),
    ],
)
def test_constant_models(A, dt, verdict, margin, linear):
    found = assess(linear(A, dt))
    assert (found.verdict, found.method) == (verdict, "eigenvalues")
    assert found.margin == pytest.approx(margin, abs=1e-12)
    assert set(found.reasons) == set(METHODS) - {"eigenvalues"}


def test_frozen_roots_say_their_coordinates_and_need_slow_variation(pulsating):
    found = assess(pulsating(), coordinates="body axes")
    assert found.coordinates == "body axes" and "in body axes" in found.reasons["frozen_time"]
    assert assess(pulsating()).coordinates == "the model's own states x1, x2"


def test_states_that_others_do_not_feel_may_be_left_out(model_of, pulsating):
    model = pulsating()
    A = np.zeros((129, 3, 3))
    A[:, 1:, 1:], A[:, 0, 1] = model.A, 1.0  # a drifting coordinate
    whole, part = assess(model_of(model.t, A)), assess(model_of(model.t, A), states=("x2", "x3"))
    assert (whole.verdict, part.verdict) == ("marginal", "stable")
    with pytest.raises(ValueError, match="state 'x9' must be one of x1, x2, x3"):
        assess(model_of(model.t, A), states=("x9",))
    for states in ((), ("x1", "x1")):
        with pytest.raises(ValueError, match=r"states = .* must (name one state or more, each once|be distinct names)"):
            assess(model_of(model.t, A), states=states)


@pytest.mark.campaign
def test_an_arm_along_its_own_motion():
    arm = TwoLinkArm.textbook()
    arm = dataclasses.replace(arm, joint_friction=(2.0, 1.0), modes=(1, 1))
    x0, u0 = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)
    model = arm.linearize(x0, u0)
    assert assess(model).verdict == "stable"
    x0, u0 = arm.equilibrium(theta1=np.pi / 2, theta2=0.0)
    assert assess(arm.linearize(x0, u0)).verdict == "unstable"
    motion = arm.simulate(arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)[0] + 0.01, None, np.linspace(0, 1, 201))
    found = assess(arm.linearize_along(motion))
    assert found.verdict == "bounded" and found.horizon is not None and "floquet" in found.reasons


@pytest.mark.parametrize("model", [3.0, "A", [1.0, 2.0], []])
def test_bad_models_are_refused(model):
    with pytest.raises(ValueError, match="must be an LTVModel, PiecewiseLTV or a list of LTVModel"):
        assess(model)


def test_bad_options_are_refused(linear, pulsating):
    model = pulsating()
    with pytest.raises(ValueError, match=r"growth.window = 9 must be > 0 and at most 3.14159 s"):
        growth(model, 9.0)
    with pytest.raises(ValueError, match=r"growth.scale = .* must be > 0"):
        growth(model, scale=[1.0, -1.0])
    with pytest.raises(ValueError, match=r"growth.duration = None must be > 0"):
        growth(linear([[0.0, 1.0], [-1.0, 0.0]]))
    assert growth(linear([[-1.0]]), duration=2.0).total == pytest.approx(np.exp(-2.0))


def test_a_nominal_at_rest_is_a_constant_model(model_of):
    A = np.broadcast_to(np.array([[0.0, 1.0], [-4.0, -0.4]]), (11, 2, 2))
    found = assess(model_of(np.linspace(0.0, 0.1, 11), A), periodic=False)
    assert (found.verdict, found.method) == ("stable", "eigenvalues") and found.margin == pytest.approx(0.2)

"""Models in signals: same input and output as in deviations."""

import numpy as np
import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody


def response(model, s):
    return model.C @ np.linalg.solve(s * np.eye(len(model.A)) - model.A, model.B) + model.D


def test_same_transfer(craft):
    x0 = craft.state(arm=0.4)
    own, model = craft.linearize(x0), craft.feedback_model(x0)
    np.testing.assert_allclose(response(model, 0.7j), response(own, 0.7j), atol=1e-12)
    words = [s.name for s in model.states]
    assert words[3:6] == [f"base_attitude_{c}" for c in "xyz"]
    assert "base_rate_x" in words
    assert "ball_rate_z" in words


def test_an_attitude_that_turns_is_left_out():
    """Of a base that turns steadily about an axis of its own, with an arm whose mass centre is where both turn: nothing
    else moves, and nothing feels where the base points.
    """
    arm = TreeBody(name="arm", joint=Joint(name="arm", axis=(0, 1, 0)), mass=1.0, inertia=0.05)
    craft = FlexibleTree.serial([arm], base="free", platform=Payload(mass=4.0, inertia=0.5), gravity=(0, 0, 0))
    x0 = craft.state(base_rate_z=0.3)
    model = craft.feedback_model(x0)
    coordinates, axes = ["base_x", "base_y", "base_z", "arm"], "xyz"
    rates = [*(f"base_{c}_rate" for c in axes), *(f"base_rate_{c}" for c in axes), "arm_rate"]
    assert [s.name for s in model.states] == coordinates + rates
    assert not any("attitude" in s.name for s in model.outputs)
    np.testing.assert_allclose(model.x0, np.where(np.array(coordinates + rates) == "base_rate_z", 0.3, 0.0), atol=1e-15)
    np.testing.assert_allclose(model.f0, 0.0, atol=1e-12)
    standing = craft.feedback_model(craft.state())
    assert [s.name for s in standing.states][3:6] == [f"base_attitude_{c}" for c in axes]


def test_an_attitude_that_turns_and_is_felt_is_refused(craft):
    x0 = craft.state(ball_rate_x=0.5)
    with pytest.raises(ValueError, match=r"the attitude of 'ball' of rigid turns at x0 \(quaternion rates \["):
        craft.feedback_model(x0)

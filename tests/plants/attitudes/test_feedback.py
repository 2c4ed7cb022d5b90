"""Models in signals: same input and output as in deviations."""

import numpy as np
import pytest


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


def test_an_attitude_that_turns_is_left_out(craft):
    """Of a base that turns steadily about its axis, where nothing else moves; not where the rest feels it."""
    x0 = craft.state(base_rate_z=0.0, ball_rate_x=0.5)
    with pytest.raises(ValueError, match=r"the attitude of 'ball' of rigid turns at x0 \(quaternion rates \["):
        craft.feedback_model(x0)

"""Controllers in state-space form: what they give is what the controller does; loops closed with any gain."""

import numpy as np
import pytest

from pliant.controllers import LQR, Feedback
from pliant.controllers.analysis.linear_laws import LinearLaw, closed_matrix, law_of, linearised, readings_under_way
from pliant.plants import PliantError
from pliant.plants.linear.lti import LinearModel

MODEL = LinearModel.from_matrices([[0, 1], [-4.0, -0.4]], [[0], [1.0]])


def test_a_law_acts_as_its_controller():
    law = LQR.design(MODEL, np.eye(2), np.eye(1), dt=0.1)
    form, y = law_of(law), np.array([0.3, -0.2])
    np.testing.assert_allclose(-form.D @ y, law.act(0.0, y), rtol=1e-12)
    np.testing.assert_allclose(linearised(law, np.zeros(2)).D, form.D, rtol=1e-6)
    assert law_of(form) is form and len(form.poles) == 0


def test_a_law_that_reads_nothing_is_of_no_columns():
    class Given:
        dt, reads = None, ()

        def reset(self):
            pass

        def act(self, t, y):
            return np.array([1.0, 2.0])

    assert linearised(Given(), np.zeros(0)).D.shape == (2, 0)


def test_what_has_no_linear_form_is_named():
    with pytest.raises(PliantError, match="str: this controller has no linear form"):
        law_of("law")


@pytest.mark.parametrize("gain", [0.0, 1.0, 2.5])
def test_a_loop_closed_with_a_gain_by_hand(gain):
    """x' = (A - g B K) x without feedthrough; with D = 1 and K = 1, u = -g (C x + u): u = -g C x / (1 + g)."""
    A, B, C = MODEL.A, MODEL.B, np.array([[1.0, 0.0]])
    law = law_of(Feedback(np.array([[1.0]]), ("x1",)))
    np.testing.assert_allclose(closed_matrix((A, B, C, np.zeros((1, 1))), law, gain), A - gain * B @ C, atol=1e-15)
    found = closed_matrix((A, B, C, np.eye(1)), law, gain)
    np.testing.assert_allclose(found, A - gain / (1 + gain) * B @ C, atol=1e-15)


def test_readings_under_way_arrive_whole_periods_later():
    A, B, C = np.array([[0.5]]), np.array([[1.0]]), np.array([[2.0]])
    A3, B3, C3 = readings_under_way(A, B, C, 3)
    x, wide, said, seen = np.zeros(1), np.zeros(4), [], []
    for k in range(8):
        u = np.array([float(k == 0)])
        said.append(float((C @ x)[0]))
        seen.append(float((C3 @ wide)[0]))
        x, wide = A @ x + B @ u, A3 @ wide + B3 @ u
    np.testing.assert_allclose(seen[3:], said[:-3], atol=1e-15)
    assert isinstance(law_of(Feedback(np.array([[1.0]]), ("x1",))), LinearLaw)

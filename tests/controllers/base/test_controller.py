"""The plainest law u = u_ref - K (y - y_ref), and what readings and limits are refused."""

import numpy as np
import pytest

from pliant.controllers import Controller, Feedback
from pliant.controllers.base.controller import LARGEST, each, ends, moment, reading, saturation


def test_feedback_by_hand():
    law = Feedback([[2.0, -1.0]], ("x", "v"), y_ref=[1.0, 0.0], u_ref=[0.5], limits=(-3.0, 2.0))
    assert isinstance(law, Controller)
    assert law.act(0.0, np.array([1.5, 0.25])) == pytest.approx([0.5 - 2 * 0.5 + 0.25])
    assert law.act(0.0, np.array([9.0, 0.0])) == -3.0 and law.act(0.0, np.array([-9.0, 0.0])) == 2.0


def test_limits_by_input():
    low, high = saturation("law", {"b": (-2.0, 1.0)}, ("a", "b"))
    assert low.tolist() == [-np.inf, -2.0] and high.tolist() == [np.inf, 1.0]
    for wrong, message in (((1.0, 1.0), "lowest < highest"), ({"c": (0.0, 1.0)}, "'c'"), (3.0, "must be a pair")):
        with pytest.raises(ValueError, match=message):
            saturation("law", wrong, ("a", "b"))


@pytest.mark.parametrize("bad", [[1.0], [np.nan, 0.0], [10 * LARGEST, 0.0]])
def test_readings_that_are_refused(bad):
    with pytest.raises(ValueError, match=r"law\.y"):
        reading("law.y", bad, 2)


def test_small_checks():
    assert each("rates", 2.0, 3).tolist() == [2.0] * 3 and ends("bounds", (-1.0, 2.0)) == (-1.0, 2.0)
    with pytest.raises(ValueError, match="lowest < highest"):
        ends("bounds", (2.0, 2.0))
    with pytest.raises(ValueError, match="finite"):
        moment("law", np.inf)
    with pytest.raises(ValueError, match=r"\(2,\)"):
        each("rates", [1.0, 2.0], 3)
    with pytest.raises(ValueError, match="dt"):
        Feedback([[1.0]], ("x",), dt=0.0)

"""What an optimisation starts from: the reading and the last input, whose change is limited, by hand."""

import numpy as np
import pytest

from pliant.controllers.mpc.constraints import Limits
from pliant.controllers.mpc.knowledge import Knowledge


def knowledge(u0, low=-1.0, high=1.0):
    limits = Limits(("u",), np.array([low]), np.array([high]), np.array([0.2]), (), np.zeros(0), np.zeros(0))
    return Knowledge(3, (np.zeros(2), np.array([u0]), np.zeros(2)), limits, None, None, {})


def test_the_reading_and_the_last_input():
    made = knowledge(0.5)
    assert made(np.array([3.0, 4.0])).tolist() == [3.0, 4.0, 0.5]
    assert made.remember(np.array([0.9])) == pytest.approx([0.7]) and made(np.zeros(2))[2] == pytest.approx(0.7)
    assert made.remember(np.array([-1.0])) == pytest.approx([0.5])
    made.reset()
    assert made.last.tolist() == [0.5] and not made.missed


@pytest.mark.parametrize(("u0", "first"), [(2.0, 1.0), (-3.0, -1.0)])
def test_an_input_past_the_limits_begins_at_the_one_next_to_it(u0, first):
    assert knowledge(u0).last.tolist() == [first]


def test_inputs_on_their_way_can_be_set():
    limits = Limits(("u",), np.array([-1.0]), np.array([1.0]), np.array([np.inf]), (), np.zeros(0), np.zeros(0))
    made = Knowledge(4, (np.zeros(2), np.zeros(1), np.zeros(2)), limits, None, None, {}, np.array([0.1, 0.2]))
    made.waiting = made.waiting + 0.5
    assert made(np.array([3.0, 4.0])).tolist() == [3.0, 4.0, 0.6, 0.7]
    made.remember(np.array([0.9]))
    assert made.waiting.tolist() == [0.7, 0.9]
    made.reset()
    assert made.waiting.tolist() == [0.1, 0.2]

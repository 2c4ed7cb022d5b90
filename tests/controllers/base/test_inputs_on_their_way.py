"""A queue of inputs, by hand."""

import numpy as np

from pliant.controllers.base.inputs_on_their_way import OnTheirWay


def test_the_oldest_leaves_first():
    made = OnTheirWay(np.array([1.0, 2.0, 3.0, 4.0]), 2)
    made.push(np.array([5.0, 6.0]))
    assert made.values.tolist() == [3.0, 4.0, 5.0, 6.0]
    made.reset()
    assert made.values.tolist() == [1.0, 2.0, 3.0, 4.0]


def test_without_a_delay_nothing_is_kept():
    made = OnTheirWay(np.zeros(0), 2)
    made.push(np.array([5.0, 6.0]))
    assert not len(made.values)

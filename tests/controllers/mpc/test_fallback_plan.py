"""The last plan moved on: inputs G p + M z + fixed of the steps after the first, until it ends."""

import types

import numpy as np

from pliant.controllers.mpc.fallback_plan import LastPlan


def test_one_input_after_the_other_until_the_end():
    plan = LastPlan(3, 1)
    assert plan.go_on() is None
    G, M, fixed = (
        np.array([[[1.0]], [[2.0]], [[3.0]]]),
        np.array([[[1.0]], [[1.0]], [[0.0]]]),
        np.array([[0.0], [0.5], [0.0]]),
    )
    step, known = types.SimpleNamespace(plan=(G, M, fixed)), np.array([10.0])
    plan.keep(step, known, np.array([0.25]))
    known[0] = 99.0  # it is copied
    assert plan.inputs().tolist() == [[10.25], [20.75], [30.0]]
    assert plan.go_on().tolist() == [20.75] and plan.go_on().tolist() == [30.0] and plan.go_on() is None
    plan.keep(step, np.array([10.0]), None)  # no limit was active
    assert plan.go_on().tolist() == [20.5]
    plan.forget()
    assert plan.go_on() is None

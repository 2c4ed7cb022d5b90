"""The last plan moved on: inputs G p + M z + fixed of the steps after the first; after its end the regulator."""

import types

import numpy as np
from elastic_hub import DT, LINK, Q, R, plan
from predictive_programs import sampled_problem

from pliant.controllers import MPC, riccati
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


def test_a_failed_solve_goes_on_with_the_plan_and_says_so(monkeypatch):
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=6, limits=(-0.5, 0.5))
    x = np.array([0.6, 0.0, 0.3, 0.0])
    controller.act(0.0, x)
    planned = plan(controller)
    solver = controller._steps[0].solver
    monkeypatch.setattr(type(solver), "solve", lambda *_: None)
    for k in range(1, 6):
        np.testing.assert_array_equal(controller.act(k * DT, x), np.clip(planned[k], -0.5, 0.5))
        assert controller.record.failures == k
    Ad, Bd, Qd, Rd, Nd, _ = sampled_problem()
    lqr = -riccati.dlqr(Ad, Bd, Qd, Rd, Nd).K @ x
    np.testing.assert_allclose(controller.act(0.3, x), np.clip(lqr, -0.5, 0.5), atol=1e-9)  # the plan has ended
    controller.reset()
    assert controller.record.failures == controller.record.calls == 0

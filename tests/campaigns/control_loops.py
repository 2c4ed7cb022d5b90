"""Interconnections of a plant's system in python-control: loops by names, series, sums, feedback."""

from __future__ import annotations

import warnings
from typing import Any

import control as ct
import numpy as np
from control_bridge import HEAVY, LINK, arm, checklist, link, near, refused

CHECKS, check = checklist()


def joint_law() -> Any:
    """u = -k y - d dy/dt + push of a link, as python-control has a gain."""
    seen = ["hub_angle", "hub_angle_rate", "push"]
    return ct.ss([], [], [], [[-4.0, -1.0, 1.0]], inputs=seen, outputs=["hub_torque"], name="law")


def loop_closed(**options: Any) -> Any:
    return ct.interconnect([link(outputs="states"), joint_law()], inputs=["push"], outputs=["hub_angle"], **options)


@check
def a_loop_is_closed_by_names() -> None:
    x = np.array([0.3, -0.1])
    near(loop_closed().dynamics(0.0, x, [0.0]), LINK.dynamics(x, [-4 * 0.3 + 0.1]))


@check
def parameters_reach_into_a_loop() -> None:
    x = np.array([0.3, -0.1])
    near(loop_closed().dynamics(0.0, x, [0.0], params=HEAVY), LINK.dynamics(x, [-1.1], p=[2.0]))
    near(loop_closed(params=HEAVY).dynamics(0.0, x, [0.0]), LINK.dynamics(x, [-1.1], p=[2.0]))
    near(loop_closed().dynamics(0.0, x, [0.0], params={**HEAVY, "of another": 1}), LINK.dynamics(x, [-1.1], p=[2.0]))


@check
def a_loop_is_linearised() -> None:
    A, B = (getattr(LINK.linearize(np.zeros(2)), name) for name in "AB")
    near(ct.linearize(loop_closed(), 0).A, A + B @ [[-4.0, -1.0]], 1e-4)


@check
def the_same_system_twice() -> None:
    s = link(outputs="states")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        both = ct.interconnect([s, s], inplist=[(0, 0), (1, 0)], outlist=[(0, 0), (1, 0)])
    near(both.dynamics(0, [0.1, 0.2, 0.3, 0.4], [1, 2])[2:], LINK.dynamics([0.3, 0.4], [2.0]))


@check
def feedback_of_a_gain() -> None:
    closed = ct.feedback(link(outputs=["hub_angle"]), ct.ss([], [], [], [[4.0]]))
    near(closed.dynamics(0.0, [0.2, 0.1], [1.0]), LINK.dynamics([0.2, 0.1], [1.0 - 0.8]))


@check
def feedback_by_method_and_sign() -> None:
    closed = link(outputs=["hub_angle"]).feedback(4.0, 1)
    near(closed.dynamics(0.0, [0.2, 0.1], [1.0]), LINK.dynamics([0.2, 0.1], [1.8]))


@check
def series_and_scaling() -> None:
    s = link(outputs=["hub_angle"])
    near((s * 2.0).dynamics(0.0, [0.2, 0.1], [1.0]), LINK.dynamics([0.2, 0.1], [2.0]))
    near((3.0 * s).output(0.0, [0.2, 0.1], [1.0]), [0.6])
    two = ct.series(ct.ss([-5.0], [5.0], [1.0], 0), s)
    assert two.nstates == 3


@check
def sums_and_differences() -> None:
    s, other = link(outputs=["hub_angle"]), link(outputs=["hub_angle"])
    x = [0.2, 0.1, 0.5, 0.3]
    near((s + other).output(0.0, x, [1.0]), [0.7])
    near((s - other).output(0.0, x, [1.0]), [-0.3])
    near((-s).output(0.0, x[:2], [1.0]), [-0.2])


@check
def sizes_that_do_not_fit_are_refused() -> None:
    refused(lambda: arm() * link(), ValueError)


@check
def side_by_side() -> None:
    model = LINK.linearize(np.zeros(2)).to_control(outputs="states")
    both = ct.append(model, model)
    near(both.A, np.kron(np.eye(2), model.A))


@check
def linear_and_nonlinear_in_one() -> None:
    lag = ct.ss([[-10.0]], [[10.0]], [[1.0]], 0, inputs=["asked"], outputs=["hub_torque"], name="motor")
    whole = ct.interconnect([lag, link(outputs="states")], inputs=["asked"], outputs=["hub_angle"])
    near(whole.dynamics(0.0, [0.5, 0.2, 0.1], [1.0]), [5.0, *LINK.dynamics([0.2, 0.1], [0.5])])

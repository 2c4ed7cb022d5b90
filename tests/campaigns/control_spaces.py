"""State spaces of linear models in python-control; its feedback, estimators and optimal control on plants."""

from __future__ import annotations

import control as ct
import numpy as np
from control import optimal as oc
from control_bridge import ARM, LINK, T, checklist, link, near, refused, rest

from pliant.plants import LinearModel

CHECKS, check = checklist()


def swing() -> LinearModel:
    return LINK.linearize(np.zeros(2))


@check
def state_space_is_the_model() -> None:
    s = swing().to_control(name="swing", outputs="states")
    assert s.name == "swing" and s.output_labels == s.state_labels
    near(s.C, np.eye(2))
    assert swing().to_control(outputs=["tip_x"]).output_labels == ["tip_x"]
    refused(lambda: swing().to_control(outputs=["tip"]), ValueError)


@check
def poles_are_eigenvalues() -> None:
    model = ARM.linearize(*rest())
    near(np.sort(ct.poles(model.to_control()).real), np.sort(model.eigenvalues.real), 1e-6)


@check
def sampling_is_pythons() -> None:
    ours, theirs = swing().discretize(0.05).to_control(), ct.c2d(swing().to_control(), 0.05)
    near(ours.A, theirs.A)
    near(ours.B, theirs.B)
    assert ours.dt == 0.05


@check
def forced_response_of_the_model() -> None:
    x, _ = swing().simulate([0.1, 0.0], [1.0], T)
    near(ct.forced_response(swing().to_control(), T, np.ones_like(T), [0.1, 0.0]).states.T, x, 1e-7)


@check
def step_and_frequency_response() -> None:
    s = swing().to_control(outputs="states")
    near(ct.step_response(s, T).states[:, 0, -1], swing().simulate([0, 0], [1.0], T)[0][-1], 1e-6)
    found = s(2j)
    near(np.abs(found), np.abs(np.linalg.solve(2j * np.eye(2) - swing().A, swing().B)), 1e-9)


@check
def the_model_comes_back() -> None:
    same = LinearModel.from_control(swing().to_control())
    near(same.A, swing().A)
    assert same.state_names == swing().state_names


@check
def lqr_of_the_linear_system() -> None:
    K, _, E = ct.lqr(ct.linearize(link(), 0), np.eye(2), np.eye(1))
    assert K.shape == (1, 2) and E.real.max() < 0


@check
def state_feedback_of_the_plant() -> None:
    s = link(outputs="states")
    K, _, _ = ct.lqr(ct.linearize(s, 0), np.eye(2), np.eye(1))
    _, closed = ct.create_statefbk_iosystem(s, K)
    near(closed.dynamics(0.0, [0.2, 0.1], [0, 0, 0]), LINK.dynamics([0.2, 0.1], -K @ [0.2, 0.1]), 1e-9)


@check
def estimator_on_the_linear_system() -> None:
    s = ct.linearize(link(outputs=["hub_angle"]), 0, name="link")
    made = ct.create_estimator_iosystem(s, np.eye(1), np.eye(1))
    assert made.nstates == 2 + 4


@check
def optimal_control_of_the_plant() -> None:
    s = link(outputs="states")
    cost = oc.quadratic_cost(s, np.eye(2), np.eye(1))
    found = oc.solve_ocp(s, np.linspace(0, 0.5, 6), [0.2, 0.0], cost, print_summary=False)
    assert found.success and found.inputs.shape == (1, 6) and found.inputs[0, 0] < 0

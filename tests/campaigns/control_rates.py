"""Rates, outputs and parameters of a plant's system in python-control, after its tests of nlsys."""

from __future__ import annotations

import copy

import control as ct
import numpy as np
from control_bridge import ARM, HEAVY, T, arm, checklist, near, refused, rest

CHECKS, check = checklist()


@check
def rates_and_outputs_are_the_plants() -> None:
    x, u = np.array([0.1, -0.2, 0.3, 0.4]), np.array([1.0, -2.0])
    near(arm().dynamics(0.0, x, u), ARM.dynamics(x, u))
    near(arm().output(0.0, x, u), ARM.measure(x, u))


@check
def rates_take_parameters() -> None:
    x, u = np.array([0.1, -0.2, 0.3, 0.4]), np.array([1.0, -2.0])
    near(arm().dynamics(0.0, x, u, params=HEAVY), ARM.dynamics(x, u, p=[2.0]))


@check
def outputs_take_parameters() -> None:
    x, u = np.array([0.1, -0.2, 0.3, 0.4]), np.array([1.0, -2.0])
    near(arm().output(0.0, x, u, params=HEAVY), ARM.measure(x, u, p=[2.0]))


@check
def parameters_of_one_call_are_forgotten() -> None:
    s, x, u = arm(), np.zeros(4), np.ones(2)
    s.dynamics(0.0, x, u, params=HEAVY)
    near(s.dynamics(0.0, x, u), ARM.dynamics(x, u))


@check
def a_system_has_default_parameters() -> None:
    s = arm(params=HEAVY)
    assert s.params == HEAVY
    near(s.dynamics(0.0, np.zeros(4), np.ones(2)), ARM.dynamics(np.zeros(4), np.ones(2), p=[2.0]))
    assert arm().params == {"payload.mass": ARM.payload.mass}


@check
def default_parameters_may_be_changed() -> None:
    s = arm()
    s.params["payload.mass"] = 2.0
    near(s.linearize(*rest()).A, ARM.linearize(*rest(), p=[2.0]).A)


@check
def unknown_parameters_are_refused() -> None:
    s, x, u = arm(), np.zeros(4), np.zeros(2)
    refused(lambda: s.dynamics(0.0, x, u, params={"payload.weight": 1.0}), ValueError)
    refused(lambda: s.output(0.0, x, u, params={"m": 1.0}), ValueError)
    refused(lambda: arm(params={"m": 1.0}), ValueError)
    refused(lambda: ct.linearize(s, x, u, params={"m": 1.0}), ValueError)
    refused(lambda: ct.input_output_response(s, T, 0.0, x, params={"m": 1.0}), ValueError)


@check
def parameters_that_are_no_numbers_are_refused() -> None:
    for bad in ("2", None, np.nan, [1.0], 1j, True):
        refused(lambda bad=bad: arm().dynamics(0.0, np.zeros(4), np.zeros(2), params={"payload.mass": bad}), ValueError)


@check
def parameters_that_are_no_mapping_are_refused() -> None:
    x, u = np.zeros(4), np.zeros(2)
    for bad in ([2.0], "payload.mass", 5, ("payload.mass", 2.0)):
        refused(lambda bad=bad: arm(params=bad), ValueError)
        refused(lambda bad=bad: arm().dynamics(0.0, x, u, params=bad), ValueError)
        refused(lambda bad=bad: ct.linearize(arm(), x, u, params=bad), ValueError)


@check
def points_that_are_no_real_numbers_are_refused() -> None:
    for bad in ("abc", 1j * np.ones(4), [[1, 2], ["3"]], object(), [None] * 4):
        refused(lambda bad=bad: ct.linearize(arm(), bad, 0.0), ValueError)
        refused(lambda bad=bad: ct.linearize(arm(), 0.0, bad), ValueError)
    refused(lambda: arm().linearize(0.0, 0.0, copy_names=3), ValueError)
    refused(lambda: arm().linearize(0.0, 0.0, minimal="yes"), ValueError)


@check
def names_come_in_any_sequence() -> None:
    for listed in (
        ["tip_y", "tip_x"],
        ("tip_y", "tip_x"),
        np.array(["tip_y", "tip_x"]),
        (n for n in ("tip_y", "tip_x")),
    ):
        assert list(arm(outputs=listed).output_labels) == ["tip_y", "tip_x"]
    assert list(arm(inputs=np.array(["tau2"])).input_labels) == ["tau2"]
    assert list(arm(disturbances=np.True_).input_labels) == list(arm(disturbances=True).input_labels)
    for bad in (1, 0, {"tau1": 1}, {"tau1"}, b"tau1", [1], True):
        refused(lambda bad=bad: arm(inputs=bad), ValueError)
    for bad in (1, 0, {"tip_force_x"}, b"x", [None], "tau1"):
        refused(lambda bad=bad: arm(disturbances=bad), ValueError)


@check
def update_and_output_functions_stand_alone() -> None:
    s = arm()
    other = ct.nlsys(s.updfcn, s.outfcn, inputs=2, outputs=s.noutputs, states=4)
    near(other.dynamics(0.0, np.zeros(4), [1.0, 0.0]), s.dynamics(0.0, np.zeros(4), [1.0, 0.0]))


@check
def lists_are_arguments() -> None:
    near(arm().dynamics(0, [0, 0, 0, 0], [1, 0]), ARM.dynamics(np.zeros(4), [1.0, 0.0]))


@check
def copies_are_apart() -> None:
    s = arm()
    for other in (copy.copy(s), copy.deepcopy(s), s.copy("b")):
        other.params["payload.mass"] = 7.0
        assert s.params["payload.mass"] == ARM.payload.mass
        near(other.linearize(*rest()).A, ARM.linearize(*rest(), p=[7.0]).A)

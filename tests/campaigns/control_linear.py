"""Linearisation and operating points of a plant's system in python-control."""

from __future__ import annotations

import warnings

import control as ct
import numpy as np
from control_bridge import ARM, CRAFT, HEAVY, arm, checklist, link, near, refused, rest

CHECKS, check = checklist()


@check
def linearisation_is_exact() -> None:
    found, model = ct.linearize(arm(), *rest()), ARM.linearize(*rest())
    for a, b in zip((found.A, found.B, found.C, found.D), (model.A, model.B, model.C, model.D)):
        near(a, b)


@check
def it_is_what_differences_come_near() -> None:
    s = arm()
    theirs = ct.nlsys(s.updfcn, s.outfcn, inputs=2, outputs=s.noutputs, states=4).linearize(*rest())
    near(ct.linearize(s, *rest()).A, theirs.A, 1e-4)


@check
def linearisation_takes_parameters() -> None:
    near(ct.linearize(arm(), *rest(), params=HEAVY).A, ARM.linearize(*rest(), p=[2.0]).A)
    near(ct.linearize(arm(), *rest(), params=HEAVY).C, ARM.linearize(*rest(), p=[2.0]).C)


@check
def linearisation_takes_an_operating_point() -> None:
    point = ct.OperatingPoint(*rest())
    near(ct.linearize(arm(), point).A, ARM.linearize(*rest()).A)
    near(ct.linearize(arm(), point, [1.0, 0.0]).A, ARM.linearize(rest()[0], [1.0, 0.0]).A)


@check
def linearisation_takes_numbers_and_parts() -> None:
    near(ct.linearize(arm(), 0, 0).A, ARM.linearize(np.zeros(4)).A)
    near(ct.linearize(arm(), [np.array([0.1, 0.2]), 0.0, 0.0]).A, ARM.linearize([0.1, 0.2, 0.0, 0.0]).A)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        near(ct.linearize(arm(), [0.1, 0.2]).A, ARM.linearize([0.1, 0.2, 0.0, 0.0]).A)
    assert any("zero" in str(w.message) for w in told)
    refused(lambda: ct.linearize(arm(), np.zeros(5)), ValueError)


@check
def the_linear_system_is_named() -> None:
    assert ct.linearize(arm(), 0, name="lin").name == "lin" and ct.linearize(arm(), 0).name == "arm$linearized"
    assert ct.linearize(arm(), 0, copy_names=True).name == "arm$linearized"


@check
def names_are_copied_or_generic() -> None:
    kept, generic = ct.linearize(arm(), 0), ct.linearize(arm(), 0, copy_names=False)
    assert kept.state_labels == arm().state_labels and kept.output_labels == arm().output_labels
    assert generic.state_labels == ["x[0]", "x[1]", "x[2]", "x[3]"] and generic.input_labels == ["u[0]", "u[1]"]


@check
def signals_of_the_linear_system_are_named() -> None:
    outputs = [f"y{k}" for k in range(arm().noutputs)]
    found = ct.linearize(arm(), 0, inputs=["a", "b"], states=["p", "q", "r", "s"], outputs=outputs)
    assert found.input_labels == ["a", "b"] and found.state_labels == ["p", "q", "r", "s"]
    assert found.output_labels == outputs and ct.linearize(link(), 0, input="a").input_labels == ["a"]


@check
def names_that_do_not_fit_are_refused() -> None:
    refused(lambda: ct.linearize(arm(), 0, inputs=["a"]), ValueError)
    refused(lambda: ct.linearize(arm(), 0, states=["a"]), ValueError)


@check
def other_keywords_are_refused() -> None:
    for options in ({"bogus": 1}, {"eps": 1e-3}, {"dt": 0.1}):
        refused(lambda options=options: ct.linearize(arm(), 0, **options), TypeError)


@check
def linearisation_has_as_many_states_as_the_system() -> None:
    s, x = CRAFT.to_control(), CRAFT.state(rate_x=0.1)
    assert ct.linearize(s, x).nstates == s.nstates == CRAFT.nx
    own = CRAFT.linearize(x)
    minimal = ct.linearize(s, x, minimal=True)
    assert minimal.nstates == len(own.states) and minimal.state_labels == list(own.state_names)
    near(minimal.A, own.A)


@check
def at_its_rest_by_default() -> None:
    near(CRAFT.to_control().linearize().A, CRAFT.jacobians(CRAFT.state())[0])
    refused(lambda: ct.linearize(CRAFT.to_control(), 0), ValueError)


@check
def operating_point_holds_the_arm() -> None:
    x0, u0 = rest()
    point = ct.find_operating_point(arm(), x0, u0 * 0.9, ix=[0, 1])
    near(point.inputs, u0, 1e-6)
    assert np.abs(arm().dynamics(0.0, point.states, point.inputs)).max() < 1e-6


@check
def operating_point_takes_parameters() -> None:
    x0, u0 = ARM.equilibrium(theta1=-0.9, theta2=0.6, p=[2.0])
    near(ct.find_operating_point(arm(), x0, 0.9 * u0, ix=[0, 1], params=HEAVY).inputs, u0, 1e-6)


@check
def operating_point_by_outputs() -> None:
    s = arm(outputs="states")
    x0, u0 = rest()
    point = ct.find_operating_point(s, x0 + 0.01, u0, y0=x0, iy=[0, 1], return_y=False)
    near(point[0][:2], x0[:2], 1e-5)

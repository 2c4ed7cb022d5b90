"""Signals and names of a plant in python-control, after its tests of iosys; which are its inputs and outputs."""

from __future__ import annotations

import control as ct
import numpy as np
from control_bridge import ARM, arm, checklist, link, near, refused, rest

CHECKS, check = checklist()


@check
def signals_have_the_plants_names() -> None:
    s = arm()
    assert s.state_labels == [n.name for n in ARM.states] and s.input_labels == [n.name for n in ARM.inputs]
    assert s.output_labels == [n.name for n in ARM.outputs] and (s.nstates, s.ninputs) == (4, 2)


@check
def a_signal_is_found_by_name() -> None:
    s = arm()
    assert s.find_state("theta2") == 1 and s.find_input("tau1") == 0 and s.find_output("nothing") is None


@check
def systems_are_named() -> None:
    assert arm().name == "arm" and ARM.to_control().name == type(ARM).__name__
    refused(lambda: ARM.to_control(name=3))


@check
def a_copy_has_another_name() -> None:
    s = arm()
    assert s.copy("other").name == "other" and s.copy().name == "arm$copy" and s.name == "arm"


@check
def names_are_changed() -> None:
    s = arm()
    s.update_names(name="new", inputs=["a", "b"], states=["p", "q", "r", "s"])
    near(ct.linearize(s, *rest()).A, ARM.linearize(*rest()).A)
    assert ct.linearize(s, *rest()).input_labels == ["a", "b"] and s.state_labels == ["p", "q", "r", "s"]


@check
def names_of_the_wrong_count_are_refused() -> None:
    refused(lambda: arm().update_names(inputs=["a"]))


@check
def timebase_is_continuous() -> None:
    s = arm()
    assert s.dt == 0 and ct.isctime(s, strict=True) and not ct.isdtime(s, strict=True) and ct.timebase(s) == 0


@check
def it_prints() -> None:
    text = str(arm())
    assert "theta1" in text and "payload.mass" in text and "arm" in repr(arm())


@check
def it_is_neither_static_nor_single() -> None:
    assert not arm().issiso() and link(outputs=["hub_angle"]).issiso()
    refused(lambda: arm()([0.0, 0.0]), TypeError)


@check
def states_are_outputs() -> None:
    s = arm(outputs="states")
    assert s.output_labels == s.state_labels
    near(s.output(0.0, [0.1, 0.2, 0.3, 0.4], [0, 0]), [0.1, 0.2, 0.3, 0.4])


@check
def some_signals_are_outputs() -> None:
    s, x = arm(outputs=["tip_y", "theta2"]), np.array([0.1, 0.2, 0.3, 0.4])
    known = dict(zip([n.name for n in ARM.outputs], ARM.measure(x)))
    near(s.output(0.0, x, [0, 0]), [known["tip_y"], 0.2])
    C = dict(zip([n.name for n in ARM.outputs], ARM.linearize(x).C))
    near(ct.linearize(s, x).C, [C["tip_y"], [0, 1, 0, 0]])


@check
def disturbances_are_inputs() -> None:
    s, x, w = arm(disturbances=True), np.array([0.1, 0.2, 0.3, 0.4]), np.array([3.0, -1.0])
    near(s.dynamics(0.0, x, [1.0, 2.0, *w]), ARM.dynamics(x, [1.0, 2.0], w=w))
    model = ARM.linearize(x, [1.0, 2.0], w=w)
    near(ct.linearize(s, x, [1.0, 2.0, *w]).B, np.hstack([model.B, model.E]))


@check
def some_inputs_are_inputs() -> None:
    s = arm(inputs=["tau2"])
    near(s.dynamics(0.0, np.zeros(4), [1.0]), ARM.dynamics(np.zeros(4), [0.0, 1.0]))
    near(ct.linearize(s, 0).B, ARM.linearize(np.zeros(4)).B[:, 1:])


@check
def unknown_signals_are_refused() -> None:
    for options in ({"outputs": "tip"}, {"inputs": ["u"]}, {"disturbances": ["gale"]}, {"outputs": ["theta1"] * 2}):
        refused(lambda options=options: arm(**options), ValueError)
    refused(lambda: arm(outputs=3), ValueError)

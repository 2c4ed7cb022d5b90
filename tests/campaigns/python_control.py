"""python-control's own contract, tried on Pliant's systems: 68 checks after the subjects of its test suites.

    python tests/campaigns/python_control.py

A seed is one check. Subjects, in the order of python-control's files: signals and names (iosys), nonlinear systems
(nlsys), linearisation, operating points, interconnections, responses, state spaces, state feedback and estimators,
discrete time, optimal control, phase planes. References are closed forms, SciPy, or python-control's own finite
differences, at what these are good for.

Not ours, and why:
  flat systems            need a flat output with its derivatives, which an elastic arm does not have
  transfer functions      of python-control's own making: models come as StateSpace
  describing functions    of static nonlinearities; a plant has states
  pickling a StateSpace   python-control keeps a lambda in it: cloudpickle and deepcopy take it, pickle does not
  discrete nonlinear      a plant is continuous: `stepper` and `LinearModel.discretize` sample it
  loops without inputs    python-control does not linearise them itself
  plots, Slycot, config   of python-control alone
  eps of linearize        refused: derivatives are exact, there is no step
  generic signal names    of linearize by default: ours are the system's unless copy_names=False
"""

from __future__ import annotations

import copy
import dataclasses
import time
import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

import by_seed
import control as ct
import numpy as np
from control import optimal as oc
from scipy.integrate import solve_ivp

from pliant.plants import FlexibleSpacecraft, LinearModel, SingleLinkArm, TwoLinkArm

ARM = dataclasses.replace(TwoLinkArm.textbook(), reduction="rigid").vary("payload.mass")
LINK = dataclasses.replace(SingleLinkArm.textbook(), kinematics="rigid").vary("payload.mass")
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="rigid", appendages=())
HEAVY = {"payload.mass": 2.0}
CHECKS: list[tuple[str, Callable[[], None]]] = []
T = np.linspace(0.0, 0.3, 31)
TIGHT = {"solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-11}}


def check(made: Callable[[], None]) -> Callable[[], None]:
    CHECKS.append((made.__name__, made))
    return made


def near(a: Any, b: Any, rtol: float = 1e-9) -> None:
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    assert a.shape == b.shape, (a.shape, b.shape)
    off = np.abs(a - b).max(initial=0.0)
    assert off <= rtol * max(np.abs(b).max(initial=0.0), 1e-12), off


def refused(ask: Callable[[], Any], kind: Any = (ValueError, TypeError)) -> None:
    try:
        ask()
    except kind as error:
        assert len(str(error)) > 10
        return
    raise AssertionError("was not refused")


def arm(**options: Any) -> Any:
    return ARM.to_control(name="arm", **options)


def link(**options: Any) -> Any:
    return LINK.to_control(name="link", **options)


@cache
def rest() -> tuple[np.ndarray, np.ndarray]:
    return ARM.equilibrium(theta1=-0.9, theta2=0.6)


def joint_law() -> Any:
    """u = -k y - d dy/dt + push of a link, as python-control has a gain."""
    seen = ["hub_angle", "hub_angle_rate", "push"]
    return ct.ss([], [], [], [[-4.0, -1.0, 1.0]], inputs=seen, outputs=["hub_torque"], name="law")


# iosys: signals and names


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


# nlsys: rates, outputs, parameters


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


# what to_control offers


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


# linearisation


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


# operating points


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


# interconnections


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


# responses


@check
def response_is_the_motion() -> None:
    u = np.vstack([np.sin(9 * T), 0 * T])
    found = ct.input_output_response(arm(), T, u, [0.1, 0, 0, 0], **TIGHT)
    truth = solve_ivp(
        lambda t, x: ARM.dynamics(x, [np.interp(t, T, u[0]), 0.0]), (0, 0.3), [0.1, 0, 0, 0], t_eval=T, rtol=1e-9,
        atol=1e-11, max_step=0.01,
    ).y  # fmt: skip
    near(found.states, truth, 1e-5)


@check
def response_takes_parameters() -> None:
    found = ct.input_output_response(link(), T, np.ones_like(T), params=HEAVY, **TIGHT)
    near(found.states.T, LINK.simulate(np.zeros(2), [1.0], T, p=[2.0]).x, 1e-6)


@check
def response_of_states_as_outputs() -> None:
    found = ct.input_output_response(link(outputs="states"), T, 1.0, [0.1, 0.0])
    near(found.outputs, found.states)
    assert found.output_labels == link().state_labels


@check
def response_at_other_times() -> None:
    found = ct.input_output_response(link(), T, np.ones_like(T), t_eval=T[::5], **TIGHT)
    near(found.states.T, LINK.simulate(np.zeros(2), [1.0], T[::5]).x, 1e-6)


@check
def response_of_a_closed_loop() -> None:
    found = ct.input_output_response(loop_closed(), T, 0.0, [0.3, 0.0], **TIGHT)
    truth = solve_ivp(
        lambda t, x: LINK.dynamics(x, [-4 * x[0] - x[1]]), (0, 0.3), [0.3, 0], t_eval=T, rtol=1e-9, atol=1e-12
    )
    near(found.states, truth.y, 1e-6)


@check
def response_from_a_given_point() -> None:
    x0, u0 = rest()
    found = ct.input_output_response(arm(), T, np.tile(u0[:, None], len(T)), x0, **TIGHT)
    near(found.states[:, -1], x0, 1e-5)


@check
def response_of_the_wrong_size_is_refused() -> None:
    refused(lambda: ct.input_output_response(arm(), T, np.zeros((3, len(T))), np.zeros(4)))


# state spaces of linear models


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


# state feedback, estimators, optimal control


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


@check
def copies_are_apart() -> None:
    s = arm()
    for other in (copy.copy(s), copy.deepcopy(s), s.copy("b")):
        other.params["payload.mass"] = 7.0
        assert s.params["payload.mass"] == ARM.payload.mass
        near(other.linearize(*rest()).A, ARM.linearize(*rest(), p=[7.0]).A)


def run(seed: int) -> dict[str, Any]:
    name, ask = CHECKS[seed]
    began, fault = time.perf_counter(), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            ask()
    except Exception as error:
        fault = f"{type(error).__name__}: {error}"[:300]
    return {"seed": seed, "name": name, "fault": fault, "seconds": round(time.perf_counter() - began, 3)}


def summary(rows: list[dict[str, Any]]) -> str:
    faults = [f"{r['name']}: {r['fault']}" for r in rows if r["fault"]]
    return "\n  ".join([f"python-control {ct.__version__}: {len(rows) - len(faults)} of {len(rows)} hold", *faults])


if __name__ == "__main__":
    by_seed.main(__doc__, len(CHECKS), run, summary, lambda row: bool(row["fault"]))

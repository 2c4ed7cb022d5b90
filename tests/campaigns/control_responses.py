"""Responses of a plant's system in python-control against the plant's own motion and SciPy's."""

from __future__ import annotations

import control as ct
import numpy as np
from control_bridge import ARM, HEAVY, LINK, TIGHT, T, arm, checklist, link, near, refused, rest
from control_loops import loop_closed
from scipy.integrate import solve_ivp

CHECKS, check = checklist()


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

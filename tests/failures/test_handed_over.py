"""What is handed over to other libraries and back: arguments, symbols, copies. Each naive way loses something."""

import copy
import dataclasses
import pickle

import casadi as ca
import control
import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import Environment, FlexibleSpacecraft, StabilityLimitError, Sun, TwoLinkArm

ARM = TwoLinkArm.textbook().vary("payload.mass")


def test_a_system_made_of_two_functions_drops_parameters_and_differences_are_not_exact():
    """The naive bridge gives the same model whatever the payload, and by differences; `to_control` the exact one."""
    x0, u0 = ARM.equilibrium(theta1=-0.9, theta2=0.6)
    sizes = {"states": ARM.nx, "inputs": ARM.nu, "outputs": ARM.ny}
    naive = control.nlsys(
        lambda t, x, u, params: ARM.dynamics(x, u), lambda t, x, u, params: ARM.measure(x, u), **sizes
    )
    light, heavy = (control.linearize(naive, x0, u0, params={"payload.mass": m}).A for m in (0.5, 5.0))
    np.testing.assert_array_equal(light, heavy)
    exact = ARM.linearize(x0, u0, p=[5.0]).A
    found = control.linearize(ARM.to_control(), x0, u0, params={"payload.mass": 5.0}).A
    np.testing.assert_array_equal(found, exact)
    assert np.abs(heavy - exact).max() > 0.1 * np.abs(exact).max()
    with pytest.raises(ValueError, match=r"params\['payload'\]: TwoLinkArm.to_control\(\) takes payload.mass"):
        control.linearize(ARM.to_control(), x0, u0, params={"payload": 5.0})
    with pytest.raises(TypeError, match="eps"):
        control.linearize(ARM.to_control(), x0, u0, eps=1e-3)


def test_a_symbol_in_a_unit_vector_ends_inside_casadi_and_vary_says_why():
    """What may be varied in its place is what the light presses with, one number."""
    lit = dataclasses.replace(
        FlexibleSpacecraft.textbook(), environment=Environment(sun=Sun(direction=(0.0, 0.6, 0.8)))
    )
    with pytest.raises(RuntimeError):  # CasADi's: a comparison of what is no number yet
        assert abs(np.linalg.norm(np.array([ca.SX.sym("s"), 0.6, 0.8])) - 1) < 1e-9
    with pytest.raises(ValueError, match="cannot be varied: it is a part of a unit vector"):
        lit.vary("environment.sun.direction.0")
    assert lit.vary("environment.sun.pressure").parameters[0].unit == "N/m^2"


def test_a_copy_by_hand_shares_what_moves_and_copy_does_not():
    """A shallow copy of an environment's attributes steps the original; copy, deepcopy and pickle give one apart."""
    env = scenes.get("single-link-slew").vector_env(2)
    env.reset(seed=0)
    naive = object.__new__(type(env))
    naive.__dict__.update(env.__dict__)
    push = np.ones((2, 1), dtype=np.float32)
    before = env.states
    naive.step(push)
    assert np.abs(env.states - before).max() > 0
    before = env.states
    for made in (copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        made.step(push)
        np.testing.assert_array_equal(env.states, before)


def test_an_error_with_more_than_a_message_comes_back_from_another_process():
    """As an Exception of its own kind with two arguments it does not: pickle calls it with the message alone."""

    error = StabilityLimitError("past its limit", 0.1, -3j, 0.02)
    kind, args = Exception.__reduce__(error)[:2]
    with pytest.raises(TypeError, match="missing 3 required positional arguments"):
        kind(*args)
    assert vars(pickle.loads(pickle.dumps(error))) == {"step": 0.1, "mode": -3j, "largest_step": 0.02}

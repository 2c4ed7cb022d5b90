"""The CasADi function of a plant: names, derivatives, every kind of expression, in a user's program."""

import dataclasses
import pickle

import casadi as ca
import numpy as np
import pytest

from pliant.plants import TwoLinkArm

ARM = TwoLinkArm.textbook()


@pytest.mark.every(6)
def test_casadi_function_has_names_derivatives_and_takes_every_kind(plant, random_state):
    f = plant.casadi()
    assert f.name_in() == ["t", "x", "u", "w", "p"] and f.name_out() == ["dx", "y"]
    assert [f.size1_in(k) for k in range(5)] == [1, plant.nx, plant.nu, plant.nw, 0]
    x, u = random_state(plant, 3), np.full(plant.nu, 0.1)
    dx, y = f(0.0, x, u, np.zeros(plant.nw), [])
    np.testing.assert_allclose(np.ravel(dx), plant.dynamics(x, u), rtol=1e-12, atol=1e-12 * np.abs(dx).max())
    np.testing.assert_allclose(np.ravel(y), plant.measure(x, u), rtol=1e-12, atol=1e-12 * np.abs(y).max())
    for kind in (ca.SX, ca.MX):
        z, v = kind.sym("z", plant.nx), kind.sym("v", plant.nu)
        g = ca.Function("g", [z, v], [ca.jacobian(f(x=z, u=v)["dx"], z)])  # t and w left out
        A = plant.jacobians(x, u)[0]
        np.testing.assert_allclose(np.array(g(x, u)), A, rtol=1e-9, atol=1e-9 * np.abs(A).max())


def test_a_parameter_of_the_casadi_function_is_not_zero_where_it_is_left_out():
    f, x = ARM.vary("payload.mass").casadi(), np.zeros(ARM.nx)
    assert np.isnan(np.array(f(x=x)["dx"])).any()
    expected = ARM.vary("payload.mass").dynamics(x, p=[2.0])
    np.testing.assert_allclose(np.ravel(f(x=x, p=2.0)["dx"]), expected, rtol=1e-10)


def test_casadi_function_stands_in_a_users_program():
    """The torques that hold an arm, found by Opti with the plant inside: weights times arms, from statics."""
    arm = dataclasses.replace(ARM, reduction="rigid")
    opti = ca.Opti()
    u = opti.variable(2)
    x = np.zeros(arm.nx)
    opti.subject_to(arm.casadi()(x=x, u=u)["dx"][2:] == 0)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    _, u0 = arm.equilibrium(theta1=0.0, theta2=0.0)
    np.testing.assert_allclose(opti.solve().value(u), u0, rtol=1e-7)


def test_the_casadi_function_travels():
    f, x = ARM.casadi(), np.full(ARM.nx, 0.01)
    same = pickle.loads(pickle.dumps(f))
    np.testing.assert_array_equal(np.array(same(x=x)["dx"]), np.array(f(x=x)["dx"]))

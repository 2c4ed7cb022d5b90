"""Order conditions of the tableaux (Hairer, Norsett, Wanner I, Table II.2.2 and the quadrature conditions)."""

import subprocess
import sys
from math import factorial

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import DOP853

from pliant.plants.core.runge_kutta_tableaux import TABLEAUS, dop853_errors, rk8

ORDERS = {"rk4": 4, "rk8": 8}


@pytest.mark.parametrize("name", TABLEAUS)
def test_quadrature_is_exact_to_the_order_and_not_beyond(name):
    """sum b_i c_i^(k-1) = 1/k."""
    tableau, order = TABLEAUS[name](), ORDERS[name]
    for k in range(1, order + 1):
        assert tableau.b @ tableau.c ** (k - 1) == pytest.approx(1 / k, abs=1e-14)
    assert abs(tableau.b @ tableau.c**order - 1 / (order + 1)) > 1e-6


@pytest.mark.parametrize("name", TABLEAUS)
def test_tall_trees(name):
    """b A^(k-1) 1 = 1/k!, which are the coefficients of the stability polynomial; rows of A sum to c."""
    tableau = TABLEAUS[name]()
    np.testing.assert_allclose(tableau.A.sum(axis=1), tableau.c, atol=1e-14)
    expected = [1 / factorial(k) for k in range(ORDERS[name] + 1)]
    np.testing.assert_allclose(tableau.polynomial[: len(expected)], expected, atol=1e-15)


@pytest.mark.parametrize("name", TABLEAUS)
def test_bushy_conditions_of_orders_three_and_four(name):
    """sum b_i a_ij c_j = 1/6, b_i c_i a_ij c_j = 1/8, b_i a_ij c_j^2 = 1/12 (trees t32, t42, t43)."""
    A, b, c = TABLEAUS[name]().A, TABLEAUS[name]().b, TABLEAUS[name]().c
    assert b @ A @ c == pytest.approx(1 / 6, abs=1e-14)
    assert (b * c) @ A @ c == pytest.approx(1 / 8, abs=1e-14)
    assert b @ A @ c**2 == pytest.approx(1 / 12, abs=1e-14)


@pytest.mark.parametrize("name", TABLEAUS)
def test_a_step_takes_time_input_and_parameters_where_they_belong(name):
    """dx/dt = p t^3 + u, the input held: x(h) = p h^4 / 4 + u h exactly for methods of order 4 and more."""
    t, x, u, w, p = (ca.SX.sym(s) for s in "txuwp")
    tableau = TABLEAUS[name]()
    step = tableau.step("step", ca.Function("f", [t, x, u, w, p], [p * t**3 + u + w]))
    after = step(0.0, 1.0, np.full((1, len(tableau.b)), 3.0), 0.5, 2.0, 0.4)
    assert float(after) == pytest.approx(1.0 + 2.0 * 0.4**4 / 4 + 3.5 * 0.4, rel=1e-14)


def test_the_pair_is_scipys_to_the_last_bit():
    tableau, (fifth, third) = rk8(), dop853_errors()
    for ours, theirs in (
        (tableau.A, DOP853.A[:12, :12]),
        (tableau.b, DOP853.B),
        (tableau.c, DOP853.C[:12]),
        (fifth, DOP853.E5[:12]),
        (third, DOP853.E3[:12]),
    ):
        np.testing.assert_array_equal(ours, theirs)
    assert DOP853.E5[12] == DOP853.E3[12] == 0.0  # the slope after the step has no part in them


def test_integration_needs_no_scipy():
    """It takes 0.3 s to import."""
    program = (
        "import sys; from pliant.plants import SingleLinkArm; arm = SingleLinkArm.textbook();"
        "arm.simulate([0.0] * arm.nx, [0.1], [0.0, 0.1]); assert 'scipy' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)

"""Functions in extended precision: exact where that is known, and spread as rounding spreads them."""

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

from pliant.plants.rounding import extended_evaluation
from pliant.plants.rounding.extended_evaluation import BY_LIBRARY, EXACT, ROUNDED_ONCE, SAMPLES, Arithmetic

DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)
TWO = {
    ca.OP_LIFT, ca.OP_COPYSIGN, ca.OP_FMIN, ca.OP_FMAX, ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_AND, ca.OP_OR,
    ca.OP_IF_ELSE_ZERO, ca.OP_FMOD, ca.OP_REMAINDER, ca.OP_ADD, ca.OP_SUB, ca.OP_MUL, ca.OP_DIV, ca.OP_POW,
    ca.OP_CONSTPOW, ca.OP_ATAN2, ca.OP_HYPOT,
}  # fmt: skip


def test_every_operation_is_casadis() -> None:
    """At points where all are defined, to the rounding of a double."""
    x = np.array([0.3, 0.7, 0.9, 0.25])
    y = np.array([0.6, 0.2, 0.9, 0.75])
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    known = Arithmetic(DOUBLE, 4)
    for op in (*EXACT, *ROUNDED_ONCE, *BY_LIBRARY):
        shift = 1.0 if op == ca.OP_ACOSH else 0.0
        made = ca.SX.binary(op, a + shift, b) if op in TWO else ca.SX.unary(op, a + shift)
        function = ca.Function("f", [a, b], [made])
        exact, _ = known.statistics(known(function)(*(known.spread(v[:, None]) for v in (x, y)))[0])
        want = np.array(function.map(4)(x[None], y[None])).ravel()
        np.testing.assert_allclose(exact.ravel().astype(float), want, rtol=1e-14, atol=0, err_msg=str(op))


def test_the_exact_columns_are_exact() -> None:
    """sum of 1 / (k + x) at x = 3/8, which fractions know; in a double the sum alone rounds 40 times."""
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [sum((1.0 / (k + x) * (-1) ** k for k in range(1, 40)), ca.SX(0))])
    known = Arithmetic(DOUBLE, 1)
    exact, spread = known.statistics(known(function)(known.spread(np.array([[0.375]])))[0])
    want = sum(Fraction((-1) ** k) / (k + Fraction(3, 8)) for k in range(1, 40))
    high = float(exact[0, 0])
    off = abs(float(Fraction(high) + Fraction(float(exact[0, 0] - known.format.type(high))) - want))
    assert off < (1e-17 if known.exact else 1e-14)
    assert 1e-17 < spread[0, 0] < 1e-14


@pytest.mark.parametrize("dtype", [DOUBLE, SINGLE])
def test_cancellation_spreads_as_its_operands_rounding(dtype) -> None:
    """a - 1 at a = 1 + x is known to no more than what rounding left of a: a relative spread of eps / x."""
    a, one = ca.SX.sym("a"), ca.SX.sym("one")
    known = Arithmetic(dtype, 5)
    small = 2.0 ** -np.arange(0.0, 15.0, 3.0)[:, None]
    exact, spread = known.statistics(known(ca.Function("f", [a, one], [a - one]))(known.spread(1.0 + small), 1.0)[0])
    np.testing.assert_allclose(exact.astype(float), small, rtol=1e-10)
    relative = (spread / exact).astype(float).ravel() * small.ravel() / known.eps
    assert (relative > 0.3).all() and (relative < 6.0).all()


def test_constants_that_single_precision_holds_do_not_move() -> None:
    x = ca.SX.sym("x")
    found = []
    for number in (0.5, 0.1):
        known = Arithmetic(SINGLE, 1)
        out = known(ca.Function("f", [x], [ca.SX(number) + 0 * x]))(known.spread(np.array([[1.0]])))[0]
        found.append(known.statistics(out)[1][0, 0])
    assert found[0] == 0.0 and 0.3 * known.eps < found[1] / 0.1 < 2 * known.eps


def test_matrices_and_sparse_outputs_have_the_virtual_machines_shape() -> None:
    x = ca.SX.sym("x", 2, 3)
    function = ca.Function("f", [x], [ca.diagcat(x[0, 0], x[1, 2]), x.T])
    known = Arithmetic(DOUBLE, 2)
    points = np.arange(12.0).reshape(2, 6)
    sparse, turned = known(function)(known.spread(points))
    assert sparse.shape == (2 * (1 + SAMPLES), 2, 2) and turned.shape == (2 * (1 + SAMPLES), 3, 2)
    want = np.array(function(points[1].reshape(2, 3, order="F"))[1])
    np.testing.assert_array_equal(turned[1].astype(float), want)
    np.testing.assert_array_equal(sparse[0].astype(float), [[0, 0], [0, 5]])


def test_a_longdouble_that_is_a_double_is_noticed(monkeypatch) -> None:
    monkeypatch.setattr(extended_evaluation, "WIDEST", np.float64)
    assert not Arithmetic(DOUBLE, 1).exact and Arithmetic(SINGLE, 1).exact


def test_an_unknown_operation_is_named() -> None:
    x = ca.SX.sym("x")
    with pytest.raises(NotImplementedError, match="is not known"):
        Arithmetic(DOUBLE, 1)(ca.Function("f", [x], [ca.SX.unary(ca.OP_ERFINV, x)]))

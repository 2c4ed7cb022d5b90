"""Rows evaluated by a function's instructions have the virtual machine's own bits, which CasADi's map is asked for."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import TwoLinkArm
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.rows.instruction_tape import READING, Tape, library
from pliant.plants.rows.tape_programs import BLOCK, COMPILING

ROWS = READING + BLOCK + 3  # more than reading takes, and no whole number of blocks


@pytest.fixture
def compiled(monkeypatch):
    """The C at hand, where there is a compiler."""
    monkeypatch.setattr(library, "spent", COMPILING)
    if library.at_hand(1.0) is None:
        pytest.skip("no compiler")


def mapped(function, *values):
    """CasADi's own answer, point by point."""
    columns = [np.broadcast_to(v, (ROWS, function.numel_in(i))).T for i, v in enumerate(values)]
    found = function.map(ROWS).call(columns)
    return [np.array(f) for f in found]


def test_an_arms_rates_and_mass_matrix_have_the_same_bits(compiled):
    arm = TwoLinkArm.textbook()
    rng = np.random.default_rng(1)
    x, u = rng.uniform(-0.3, 0.3, (ROWS, arm.nx)), rng.uniform(-1.0, 1.0, (ROWS, arm.nu))
    rates = NumericFunction(arm._dynamics._function)
    found = rates(0.0, x, u, *arm.quiet, batch=ROWS)
    assert isinstance(rates._rows._tape, Tape)
    for own, known in zip(found, mapped(arm._dynamics._function, 0.0, x, u, *arm.quiet)):
        np.testing.assert_array_equal(own, known.T)


def test_matrices_and_other_operations(compiled):
    x, k = ca.SX.sym("x", 3), ca.SX.sym("k")
    steps = ca.if_else(x[0] < k, ca.fmin(x[1], ca.floor(3 * x[2])), ca.sign(x[0]) * ca.atan2(x[1], x[2]))
    function = ca.Function(
        "f", [x, k], [ca.densify(ca.jacobian(ca.sin(x) * ca.sum1(x**3), x)), steps / ca.sqrt(1 + k**2)]
    )
    values = np.random.default_rng(2).uniform(-1.0, 1.0, (ROWS, 3))
    numeric = NumericFunction(function, matrices=True)
    found = numeric(values, 0.25, batch=ROWS)
    known = mapped(function, values, 0.25)
    np.testing.assert_array_equal(found[0], known[0].reshape(3, ROWS, 3).transpose(1, 0, 2))
    np.testing.assert_array_equal(found[1][:, 0, 0], known[1][0])
    assert numeric._rows._tape is not None
    with pytest.raises(ValueError, match="broadcast"):
        numeric(values[:, :2], 0.25, batch=ROWS)


def test_of_zeros_of_two_signs_the_smaller_and_the_larger_are_the_virtual_machines(compiled):
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    function = ca.Function("f", [a, b], [1 / ca.fmin(a, b), 1 / ca.fmax(a, b)])
    values = (
        np.resize([0.0, 0.0, -0.0, -0.0, np.nan, 1.0], (ROWS, 1)),
        np.resize([0.0, -0.0, 0.0, -0.0, 1.0], (ROWS, 1)),
    )
    for own, known in zip(Tape(function, library.run)(values, ROWS), mapped(function, *values)):
        np.testing.assert_array_equal(own, known.T)


def test_few_rows_and_what_c_has_not_stay_on_the_virtual_machine(compiled, monkeypatch):
    x = ca.SX.sym("x")
    few = NumericFunction(ca.Function("few", [x], [x * x]))
    few(np.ones((READING - 1, 1)), batch=READING - 1)
    assert few._rows._tape is None
    other = NumericFunction(ca.Function("other", [x], [ca.erf(x)]))
    assert other(np.zeros((ROWS, 1)), batch=ROWS)[0].max() == 0.0
    assert other._rows._tape is None
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    unwanted = NumericFunction(ca.Function("unwanted", [x], [x + x]))
    assert unwanted(np.ones((ROWS, 1)), batch=ROWS)[0].min() == 2.0
    assert unwanted._rows._tape is None


def test_a_function_without_results_has_none(compiled):
    nothing = NumericFunction(ca.Function("nothing", [ca.SX.sym("x", 2)], [ca.SX(0, 1)]))
    assert nothing(np.ones((ROWS, 2)), batch=ROWS)[0].shape == (ROWS, 0)

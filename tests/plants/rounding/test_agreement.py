"""The comparison of compiled code with the truth: what passes, what does not, and points that tell nothing."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.rounding import agreement, extended_evaluation
from pliant.plants.rounding.agreement import KernelMismatch, Trial, of_function, require_agreement, truth

DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)
X = ca.SX.sym("x", 3)
SOLVED = ca.Function("solved", [X], [ca.solve(ca.SX(np.array([[1e3, 1.0], [1.0, 2e-3]])), ca.sin(X[:2]) * X[2])])


def compiled(wrong=0.0, dtype=SINGLE):
    """`SOLVED` in NumPy at a precision, as compiled code with one factor off by `wrong`, in another order."""
    a, b, c, d = (dtype.type(v) for v in (1e3, 1.0, 1.0, 2e-3))

    def run(trial, inputs, results):
        x, y, z = inputs[0]
        r, s = np.sin(x) * z, z * np.sin(y) * dtype.type(1 + wrong)
        inverse = dtype.type(1) / (a * d - b * c)
        results[0][0], results[0][1] = (d * r - b * s) * inverse, (a * s - c * r) * inverse

    return run


def points(rng):
    return [rng.uniform(-1.0, 1.0, (3, 64))]


def agree(run, function=SOLVED, dtype=SINGLE, draw=points, lanes=32):
    return require_agreement(run, [Trial(of_function(function), draw)], dtype, lanes, "a kernel")


@pytest.mark.parametrize("widest", [np.longdouble, np.float64])
@pytest.mark.parametrize("dtype", [DOUBLE, SINGLE])
def test_a_sound_kernel_passes_with_room(dtype, widest, monkeypatch) -> None:
    """Also where `longdouble` is no wider than a double."""
    monkeypatch.setattr(extended_evaluation, "WIDEST", widest)
    most, together = agree(compiled(dtype=dtype), dtype=dtype)
    assert most < agreement.MOST / 2 and together < agreement.TOGETHER / 2


@pytest.mark.parametrize("dtype", [DOUBLE, SINGLE])
def test_a_fault_of_a_few_roundings_is_told(dtype) -> None:
    """The solution is conditioned like 1: 60 roundings of a factor show, in single precision too."""
    with pytest.raises(KernelMismatch, match=r"compiled code of a kernel disagrees .* in output 0, row [01]"):
        agree(compiled(wrong=60 * float(np.finfo(dtype).eps), dtype=dtype), dtype=dtype)


def test_no_number_disagrees() -> None:
    def run(trial, inputs, results):
        compiled()(trial, inputs, results)
        results[0][1, 5] = np.nan

    with pytest.raises(KernelMismatch, match=r"row 1, is no number .* rest_state"):
        agree(run)


def test_points_where_the_truth_is_no_number_are_drawn_again() -> None:
    """The root is real at a third of the points; both results being no number there says nothing."""
    function = ca.Function("root", [X], [ca.sqrt(X[0] - 0.33) + X[1]])

    def run(trial, inputs, results):
        assert (inputs[0][0] > 0.33).all()
        results[0][0] = np.sqrt(inputs[0][0] - 0.33) + inputs[0][1]

    assert agree(run, function, DOUBLE)[0] < 1.5


def test_where_nothing_can_be_compared_that_is_said() -> None:
    nowhere = ca.Function("nowhere", [X], [ca.sqrt(-1 - X[0] ** 2)])
    with pytest.raises(KernelMismatch, match=r"could not be compared .* are its values finite"):
        agree(compiled(), nowhere)
    lost = ca.Function("lost", [X], [X[0] - X[1]])
    with pytest.raises(KernelMismatch, match="leaves no digit"):
        agree(lambda trial, inputs, results: None, lost, draw=lambda rng: [np.full((3, 64), 1e12)])


def test_newton_steps_that_diverge_tell_nothing() -> None:
    """x - f / f' of atan from far off goes to 1e40 and beyond in a few steps; near zero it converges.

    Its true steps from x = 1.2 and 1.6, by hand: x - atan(x) (1 + x^2); Ortega and Rheinboldt 1970 on the basin,
    |x| < 1.3917.
    """
    x = ca.SX.sym("x")
    step = ca.Function("step", [x], [x - ca.atan(x) * (1 + x**2)])

    def written(numeric):
        f = numeric(step)

        def reference(x, scalars, count):
            for _ in range(count):
                x = f(x, batch=len(x))[0]
            return [x]

        return reference

    trial = Trial(written, lambda rng: [rng.uniform(-3.0, 3.0, (1, 64))], count=9)
    assert (np.abs(truth(trial, SINGLE, 32, "newton").inputs[0]) < 1.3918).all()

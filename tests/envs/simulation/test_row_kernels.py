"""Functions of rows: any number of rows, each as if it were alone."""

import casadi as ca
import numpy as np

from pliant.envs.simulation.row_kernels import Iteration, Rows

A, B = ca.SX.sym("a", 2), ca.SX.sym("b")
RNG = np.random.default_rng(1)
POINTS = [RNG.uniform(1.0, 2.0, (2, 40)), RNG.uniform(1.0, 2.0, (1, 40))]


def test_rows_are_computed_each_on_its_own() -> None:
    rows = Rows(ca.Function("f", [A, B], [A * B, ca.sin(B)]), POINTS)
    for n in (1, 8, 9, 63, 65, 2000):
        a, b = RNG.normal(size=(n, 2)), RNG.normal(size=(n, 1))
        product, sine = rows(a, b)
        np.testing.assert_allclose(product, a * b, rtol=1e-15)
        np.testing.assert_allclose(sine, np.sin(b), rtol=1e-14, atol=1e-15)


def test_iteration_adds_its_change_as_often_as_asked() -> None:
    """Newton's method for the square root, quadratic: five steps from within a factor of two are exact.

    The last change d leaves d^2 / (2 sqrt(b)).
    """
    z, b = ca.SX.sym("z"), ca.SX.sym("b")
    newton = Iteration(ca.Function("newton", [z, b], [(b / z - z) / 2]), [POINTS[1], POINTS[1]])
    wanted = RNG.uniform(1.0, 2.0, (70, 1))
    found, change = newton(np.full_like(wanted, 1.5), wanted**2, count=5)
    np.testing.assert_allclose(found, wanted, rtol=1e-15)
    assert np.abs(change).max() < 1e-10
    once, _ = newton(np.full_like(wanted, 1.5), wanted**2, count=1)
    np.testing.assert_allclose(once, 1.5 + (wanted**2 / 1.5 - 1.5) / 2, rtol=1e-15)

"""Order conditions of the Rosenbrock methods (Hairer and Wanner II, Section IV.7, Table 7.1), and what they damp."""

import numpy as np
import pytest

from pliant.plants.rosenbrock.tableaux import rodas3, rodas5p

METHODS = {"rodas3": (rodas3, 3), "rodas5p": (rodas5p, 5)}


def trees(b, alpha, beta):
    """(order, what it is, 1 / what it must be) of every condition up to order 5."""
    a, s = alpha.sum(axis=1), beta.sum(axis=1)
    return [
        (1, b.sum(), 1),
        (2, b @ s, 2),
        (3, b @ a**2, 3),
        (3, b @ beta @ s, 6),
        (4, b @ a**3, 4),
        (4, b @ (a * (alpha @ s)), 8),
        (4, b @ beta @ a**2, 12),
        (4, b @ beta @ beta @ s, 24),
        (5, b @ a**4, 5),
        (5, b @ (a**2 * (alpha @ s)), 10),
        (5, b @ (alpha @ s) ** 2, 20),
        (5, b @ (a * (alpha @ a**2)), 15),
        (5, b @ (a * (alpha @ beta @ s)), 30),
        (5, b @ beta @ a**3, 20),
        (5, b @ beta @ (a * (alpha @ s)), 40),
        (5, b @ beta @ beta @ a**2, 60),
        (5, b @ beta @ beta @ beta @ s, 120),
    ]


@pytest.mark.parametrize("name", METHODS)
def test_conditions_up_to_the_order_hold_and_some_beyond_do_not(name):
    tableau, order = METHODS[name][0](), METHODS[name][1]
    alpha, beta, b = tableau.untransformed
    off = dict.fromkeys(range(1, 6), 0.0)
    for n, found, wanted in trees(b, alpha, beta):
        off[n] = max(off[n], abs(found - 1 / wanted))
    assert max(off[n] for n in range(1, order + 1)) < 1e-12
    assert all(off[n] > 1e-3 for n in range(order + 1, 6))


@pytest.mark.parametrize("name", METHODS)
def test_without_the_last_stage_it_is_of_the_embedded_order(name):
    tableau = METHODS[name][0]()
    alpha, beta, _ = tableau.untransformed
    b = (tableau.m * np.append(np.ones(len(tableau.d) - 1), 0.0)) @ (beta - alpha)
    off = [(n, abs(found - 1 / wanted)) for n, found, wanted in trees(b, alpha, beta)]
    assert max(e for n, e in off if n <= tableau.order) < 1e-12
    assert max(e for n, e in off if n == tableau.order + 1) > 1e-3


def test_dense_output_is_of_order_four_within_the_step():
    """Conditions at the fraction c: b(c) of a tree of order n is c^n of that of the whole step."""
    tableau = rodas5p()
    alpha, beta, _ = tableau.untransformed
    for c in (0.25, 0.6, 0.9):
        for n, found, wanted in trees(tableau.along(c) @ (beta - alpha), alpha, beta):
            assert n == 5 or found == pytest.approx(c**n / wanted, abs=1e-12)
    np.testing.assert_allclose(tableau.along(1.0), tableau.m, rtol=1e-15)
    for c in (0.0, 0.3, 1.0):
        change = (tableau.along(c + 1e-6) - tableau.along(c - 1e-6)) / 2e-6
        np.testing.assert_allclose(tableau.slope_along(c), change, atol=1e-7 * np.abs(change).max())


@pytest.mark.parametrize("name", METHODS)
def test_rows_add_up_to_where_stages_stand(name):
    tableau = METHODS[name][0]()
    alpha, beta, b = tableau.untransformed
    np.testing.assert_allclose(alpha.sum(axis=1), tableau.alpha, atol=2e-14)
    np.testing.assert_allclose((beta - alpha).sum(axis=1), tableau.d, atol=2e-14)
    np.testing.assert_allclose(b, beta[-1], atol=1e-14)  # stiffly accurate


@pytest.mark.parametrize("name", METHODS)
def test_stiff_modes_are_damped_at_once_and_none_grows(name):
    """R(z) = 1 + z b (I - z beta)^-1 1 tends to 0, and |R| <= 1 along the imaginary axis: L-stable."""
    _, beta, b = METHODS[name][0]().untransformed
    one = np.ones(len(b))

    def growth(z):
        return abs(1 + z * b @ np.linalg.solve(np.eye(len(b)) - z * beta, one))

    assert growth(-1e9) < 1e-7 and growth(1e9j) < 1e-7
    assert max(growth(1j * w) for w in np.logspace(-3, 4, 400)) <= 1 + 1e-13

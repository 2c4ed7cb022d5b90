"""Exponentials and transition matrices of many steps: SciPy's, orders, closed forms of costs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm, svdvals

from pliant.plants.core.signals import GAUSS
from pliant.plants.linear import magnus

RNG = np.random.default_rng(1)
M0, M1 = RNG.standard_normal((2, 3, 3))


def matrix_at(t):
    return M0 + np.cos(2 * np.asarray(t))[..., None, None] * M1


@pytest.fixture(scope="module")
def wanted():
    """Phi(2, 0), by integration to 1e-13."""
    flat = solve_ivp(lambda t, z: (matrix_at(t) @ z.reshape(3, 3)).ravel(), (0, 2), np.eye(3).ravel(), "DOP853",
                     rtol=1e-13, atol=1e-13)  # fmt: skip
    return flat.y[:, -1].reshape(3, 3)


def test_stacked_exponential_is_scipys():
    A = np.random.default_rng(0).standard_normal((7, 6, 6)) * np.logspace(-6, 1.5, 7)[:, None, None]
    for mine, its in zip(magnus.expm(A), expm(A), strict=True):
        np.testing.assert_allclose(mine, its, rtol=0, atol=1e-12 * np.abs(its).max())


def test_steps_are_of_order_six(wanted):
    def error(m):
        edges = np.linspace(0.0, 2.0, m + 1)
        at = edges[:-1, None] + np.diff(edges)[:, None] * magnus.GAUSS3
        return np.abs(magnus.product(magnus.steps(matrix_at(at), np.diff(edges))) - wanted).max()

    assert 5.5 < np.log2(error(16) / error(32)) < 7.5


def test_exponent_is_of_order_four(wanted):
    def error(m):
        edges = np.linspace(0.0, 2.0, m + 1)
        at = edges[:-1, None] + np.diff(edges)[:, None] * GAUSS
        return np.abs(magnus.product(expm(magnus.exponent(matrix_at(at), np.diff(edges)))) - wanted).max()

    assert 3.7 < np.log2(error(64) / error(128)) < 4.3


def test_rows_of_zeros_need_not_be_given():
    N = RNG.standard_normal((4, 2, 2, 5))
    square = np.zeros((4, 2, 5, 5))
    square[:, :, :2] = N
    h = np.array([0.1, 0.2, 0.3, 0.4])
    whole = magnus.exponent(square, h)
    np.testing.assert_allclose(magnus.exponent(N, h), whole[:, :2], atol=1e-15)
    assert not whole[:, 2:].any()


def test_products_are_in_the_order_of_time():
    Phi = RNG.standard_normal((7, 2, 2))
    by_hand = np.linalg.multi_dot(Phi[::-1])
    np.testing.assert_allclose(magnus.product(Phi), by_hand, rtol=1e-12)
    grouped = magnus.grouped(Phi, np.array([0, 3, 7]))
    np.testing.assert_allclose(grouped[1] @ grouped[0], by_hand, rtol=1e-12)


@pytest.mark.parametrize("rate", [0.5, 40.0, -700.0])
def test_cost_of_one_state_in_closed_form(rate):
    """The integral over a unit step of m e^(2 a s) is m (e^(2 a) - 1) / 2 a, also for a that decays in no time."""
    F, M = np.array([[rate]]), np.array([[3.0]])
    step, cost = magnus.with_cost(F, M, -F.T, magnus.halvings(F))
    np.testing.assert_allclose(step, np.exp(F), rtol=1e-11)
    np.testing.assert_allclose(cost, 3.0 * np.expm1(2 * F) / (2 * F), rtol=1e-11)


def test_cost_of_a_vibration_in_closed_form():
    """x = cos 5 t: the integral of x^2 over T = 3 is T/2 + sin(10 T) / 20; of x'x it is (cos^2 5 T - 1) / 2."""
    F, T = 3.0 * np.array([[0.0, 1.0], [-25.0, 0.0]]), 3.0
    one = np.array([[1.0, 0.0], [0.0, 0.0]])
    _, cost = magnus.with_cost(F, T * one, -F.T, magnus.halvings(F))
    assert cost[0, 0] == pytest.approx(T / 2 + np.sin(10 * T) / 20, rel=1e-12)


def test_halvings():
    assert magnus.halvings(np.zeros((2, 2))) == 0
    assert magnus.halvings(np.array([[1.0]])) == 0
    assert magnus.halvings(np.array([[[0.5, 0.0], [0.0, 0.5]], [[3.0, 5.0], [0.0, 1.0]]])) == 3


def test_largest_growths():
    """Against SciPy's singular values; far from one, zero, and what is no number."""
    size = 10.0 ** np.array([0, 150, -150, 3, 0, 0, -8])[:, None, None]
    Phi = np.random.default_rng(4).standard_normal((7, 5, 5))
    Phi[4] = 0.0
    wanted = [svdvals(P)[0] * unit for P, unit in zip(Phi, size[:, 0, 0])]
    np.testing.assert_allclose(magnus.largest_growths(Phi * size), wanted, rtol=1e-13)
    Phi[2, 0, 0] = np.nan
    assert np.isnan(magnus.largest_growths(Phi)[2])


@pytest.mark.parametrize("k", [1, 2])
def test_a_drive_of_few_columns(k):
    """As the exponential of the whole, and as SciPy integrates it: of fourth order in the step."""
    E = RNG.standard_normal((12, k))
    A = RNG.standard_normal((2, 12, 12)) / 4

    def at(s):
        return A[0] + np.sin(s) * A[1], np.cos(s) * E

    def rate(s, W):
        matrix, drive = at(s)
        both = matrix @ W.reshape(12, 12)
        return (both + both.T + drive @ drive.T).ravel()

    missed = []
    for h in (0.2, 0.1):
        parts = [at(s) for s in h * GAUSS]
        A2, E2 = (np.array(values)[None] for values in zip(*parts))
        found = magnus.reached_by(A2, E2, np.array([h]))
        np.testing.assert_allclose(found, magnus.reached(A2, E2 @ E2.swapaxes(-1, -2), np.array([h])), atol=1e-15)
        true = solve_ivp(rate, (0, h), np.zeros(144), rtol=1e-12, atol=1e-15).y[:, -1].reshape(12, 12)
        missed.append(np.abs(found[0] - true).max())
    assert missed[0] > 20 * missed[1] and missed[0] < 1e-4

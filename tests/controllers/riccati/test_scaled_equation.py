"""The Riccati equation in even units: the same gain from any units, and how far it is known."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are, solve_discrete_are

from pliant.controllers import riccati
from pliant.controllers.riccati import scaled_equation
from pliant.controllers.riccati.scaled_equation import Problem, solve_riccati
from pliant.plants import PliantError

DOUBLE = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])


def problem(seed, n=4, m=2):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n + m, n + m))
    M = root @ root.T + np.eye(n + m)
    return Problem(rng.normal(size=(n, n)), rng.normal(size=(n, m)), M[:n, :n], M[n:, n:], M[:n, n:]), rng


@pytest.mark.parametrize("dt", [None, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_units_change_nothing(seed, dt):
    """In units of 1e-9 to 1e+9 of each state and input, and 1e+7 of the cost, against SciPy in the first ones."""
    one, rng = problem(seed)
    x, u = 10 ** rng.uniform(-9, 9, 4), 10 ** rng.uniform(-9, 9, 2)
    A, B, Q, R, N = one.scaled(x, u)
    P, K = solve_riccati(A, B, 1e7 * Q, 1e7 * R, 1e7 * N, dt)
    right = (solve_continuous_are if dt is None else solve_discrete_are)(*one[:4], s=one.N)
    np.testing.assert_allclose(P / 1e7 / x / x[:, None], right, rtol=0, atol=1e-11 * np.abs(right).max())
    again = solve_riccati(*one, dt)[1]
    np.testing.assert_allclose(K * u[:, None] / x, again, rtol=0, atol=1e-12 * np.abs(again).max())


@pytest.mark.parametrize("pace", [1e-9, 1e9])
def test_the_unit_of_time_changes_nothing(pace):
    (A, B, Q, R, N), _ = problem(3)
    P, K = solve_riccati(A, B, Q, R, N, None)
    other, gain = solve_riccati(A * pace, B * pace, Q * pace, R * pace, N * pace, None)
    np.testing.assert_allclose(gain, K, rtol=0, atol=1e-13 * np.abs(K).max())
    np.testing.assert_allclose(other, P, rtol=0, atol=1e-13 * np.abs(P).max())


def test_many_undamped_modes_as_they_are_written():
    """20 modes to 1e4 rad/s in [q, q'], and in [w q, q']: the same law; SciPy's residual of the first is 6e-5."""
    n, rng = 20, np.random.default_rng(0)
    w = np.linspace(1, 1e4, n)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w**2), np.zeros((n, n))]])
    B, unit = np.vstack([np.zeros((n, 1)), rng.normal(size=(n, 1))]), np.concatenate([w, np.ones(n)])
    made = riccati.lqr(A, B, np.eye(2 * n), np.eye(1))
    scaled = riccati.lqr(unit[:, None] * A / unit, unit[:, None] * B, np.diag(unit**-2.0), np.eye(1))
    np.testing.assert_allclose(made.K, scaled.K * unit, rtol=0, atol=1e-9 * np.abs(made.K).max())
    assert made.poles.real.max() < 0


def test_two_growing_modes_that_are_nearly_one_are_refused_not_guessed():
    """x' = diag(1, 1 + e) x + [1, 1]' u, Q -> 0: poles go to -1, -1 - e, and Ackermann's formula gives the gain
    k2 = (2 + e)(2 + 2 e)/e, k1 = -2 (2 + e)/e. With e = 1e-3 it is found, with 1e-7 rounding has eaten it."""
    e, one = 1e-3, np.ones((2, 1))
    found = riccati.lqr(np.diag([1, 1 + e]), one, 1e-12 * np.eye(2), np.eye(1)).K[0]
    np.testing.assert_allclose(found, [-2 * (2 + e) / e, (2 + e) * (2 + 2 * e) / e], rtol=1e-5)
    with pytest.raises(PliantError, match=r"relative residual of|known only to"):
        riccati.lqr(np.diag([1, 1 + 1e-7]), one, np.eye(2), np.eye(1))


def test_doubt_is_what_rounding_of_the_data_does(monkeypatch):
    """x' = x + u, q = 3: k = 1 + 2, and moved by at most four roundings; refused where less is asked for."""
    one = np.ones((1, 1))
    P, K = solve_riccati(one, one, 3 * one, one, 0 * one, None)
    assert K[0, 0] == pytest.approx(3.0, rel=1e-15)
    doubt, slowest = scaled_equation._doubt(Problem(one, one, 3 * one, one, 0 * one), P, K, None)
    assert 0 < doubt <= 4 * 2.3e-16 and slowest == pytest.approx(-2.0)
    monkeypatch.setattr(scaled_equation, "LARGEST_DOUBT", 0.0)
    with pytest.raises(PliantError, match="slowest pole is -2"):
        solve_riccati(one, one, 3 * one, one, 0 * one, None)


@pytest.mark.parametrize("dt", [None, 1.0])
@pytest.mark.parametrize("error", [np.linalg.LinAlgError("none"), ValueError("reordering failed")])
def test_doubling_where_scipy_gives_up(dt, error, monkeypatch):
    def fails(*args, **options):
        raise error

    (A, B, Q, R, N), _ = problem(5)
    right = (solve_continuous_are if dt is None else solve_discrete_are)(A, B, Q, R, s=N)
    monkeypatch.setattr(scaled_equation.sla, "solve_continuous_are", fails)
    monkeypatch.setattr(scaled_equation.sla, "solve_discrete_are", fails)
    P, _ = solve_riccati(A, B, Q, R, N, dt)
    np.testing.assert_allclose(P, right, rtol=0, atol=1e-11 * np.abs(right).max())
    with pytest.raises(PliantError, match="was not solved"):  # nothing reaches what grows
        solve_riccati(3 * np.eye(2), np.zeros((2, 1)), np.eye(2), np.eye(1), np.zeros((2, 1)), dt)


def test_a_wrong_solution_is_refused(monkeypatch):
    good = scaled_equation.sla.solve_continuous_are
    monkeypatch.setattr(scaled_equation.sla, "solve_continuous_are", lambda *a, **k: -good(*a, **k))
    np.testing.assert_allclose(
        riccati.lqr(*DOUBLE, np.eye(2), np.eye(1)).K, [[1, np.sqrt(3)]], rtol=1e-13
    )  # by doubling
    monkeypatch.setattr(scaled_equation, "_doubled", lambda *a: None)
    with pytest.raises(PliantError, match="relative residual of"):
        riccati.lqr(*DOUBLE, np.eye(2), np.eye(1))


@pytest.mark.parametrize("dt", [None, 1.0])
def test_newton_steps_find_the_solution_of_a_problem_with_a_cross_weight(dt, monkeypatch):
    """From a solution that is wrong by 1e-3: each step squares that, with every term of the cost in it."""
    A, B, Q, R, N = problem(4)[0]
    A = A if dt is None else A / np.abs(np.linalg.eigvals(A)).max()
    name = "solve_continuous_are" if dt is None else "solve_discrete_are"
    right = getattr(scaled_equation.sla, name)
    P = right(A, B, Q, R, s=N)
    monkeypatch.setattr(
        scaled_equation.sla, name, lambda *a, **k: right(*a, **k) * (1 + 1e-3)
    )  # in the solver's own units
    found, _ = scaled_equation.solve_riccati(A, B, Q, R, N, dt)
    np.testing.assert_allclose(found, P, rtol=0, atol=1e-9 * np.abs(P).max())


@pytest.mark.parametrize(("dt", "a"), [(None, 1.0), (1.0, 2.0)])
def test_a_solution_whose_loop_grows_is_refused(dt, a, monkeypatch):
    """P = 0 solves the equation of x' = a x + u without a cost of x, and does nothing."""
    one = np.ones((1, 1))
    name = "solve_continuous_are" if dt is None else "solve_discrete_are"
    monkeypatch.setattr(scaled_equation.sla, name, lambda *a, **k: 0 * one)
    with pytest.raises(PliantError, match="does not decay: a pole is"):
        scaled_equation.solve_riccati(a * one, one, 0 * one, one, 0 * one, dt)

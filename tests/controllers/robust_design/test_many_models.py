"""Cost and slope against Riccati's solution, finite differences and a sum over time; descent from an unstable law."""

import numpy as np
import pytest

from pliant.controllers import riccati
from pliant.controllers.robust_design.many_models import Models, cost, descend, lyapunov, radii

RNG = np.random.default_rng(4)


def part(n, nu, ny, A=None):
    A = RNG.normal(size=(n, n)) * 0.2 if A is None else A
    half = RNG.normal(size=(n, n))
    X = np.diag(RNG.uniform(0.1, 1.0, n))
    N = 0.1 * RNG.normal(size=(n, nu))
    C, V = RNG.normal(size=(ny, n)), 0.01 * np.diag(RNG.uniform(0.5, 1.0, ny))
    return A, RNG.normal(size=(n, nu)), C, half @ half.T + np.eye(n), np.eye(nu), N, X, V, RNG.normal(size=(n, 1))


def free(shape):
    return lambda theta: (theta.reshape(shape), lambda slope: slope.ravel())


def test_one_model_whose_states_are_read_has_riccatis_gain_and_cost():
    A, B, _, Q, R, N, X, _, x0 = part(4, 2, 4)
    models = Models.of([(A, B, np.eye(4), Q, R, N, X, np.zeros((4, 4)), x0)])
    best = riccati.dlqr(A, B, Q, R, N)
    at = cost(models, -best.K)
    start = X + x0 @ x0.T
    assert at.cost == pytest.approx(float(np.trace(best.P @ start)), rel=1e-9)
    assert np.abs(at.slope).max() < 1e-7 * at.cost
    theta, found = descend(models, np.zeros(8), free((2, 4)), np.ones(8))
    assert found.cost == pytest.approx(at.cost, rel=1e-4) and found.cost >= at.cost * (1 - 1e-9)
    np.testing.assert_allclose(theta.reshape(2, 4), -best.K, atol=0.05)


@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_slope_is_that_of_finite_differences(discount):
    """Models of two sizes, with noise of readings and a law with a history."""
    models = Models.of([part(3, 2, 2), part(5, 2, 2)]).with_history(2, 1)
    T = np.vstack([0.05 * RNG.normal(size=(2, 4)), np.hstack([np.eye(2), np.zeros((2, 2))])])
    found = cost(models, T, discount)
    assert np.isfinite(found.cost)
    for i, j in ((0, 0), (1, 2), (0, 3)):
        step = np.zeros_like(T)
        step[i, j] = 1e-6
        central = (cost(models, T + step, discount).cost - cost(models, T - step, discount).cost) / 2e-6
        assert found.slope[i, j] == pytest.approx(central, rel=1e-6)


def test_cost_is_the_sum_over_time_and_history_starts_as_the_first_reading():
    A, B, C, Q, R, N, X, V, x0 = part(3, 1, 2, np.diag([0.9, 0.5, -0.3]))
    models = Models.of([(A, B, C, Q, R, N, 0 * X, 0 * V, x0)]).with_history(2, 1)
    K = 0.05 * RNG.normal(size=(1, 4))
    x, old, total = x0[:, 0], C @ x0[:, 0], 0.0
    for _ in range(3000):
        u = K @ np.concatenate([C @ x, old])
        total += float(x @ Q @ x + u @ R @ u + 2 * x @ N @ u)
        old, x = C @ x, A @ x + B @ u
    T = np.vstack([K, np.hstack([np.eye(2), np.zeros((2, 2))])])
    assert cost(models, T).cost == pytest.approx(total, rel=1e-10)


def test_lyapunov_sum_and_what_is_not_stable():
    F = np.array([[[0.5, 1.0], [0.0, -0.2]]])
    X = lyapunov(F, np.eye(2)[None])
    np.testing.assert_allclose(X, F @ X @ F.swapaxes(1, 2) + np.eye(2), rtol=1e-12)
    models = Models.of([part(2, 1, 2, np.diag([1.1, 0.2]))])
    assert cost(models, np.zeros((1, 2))).cost == np.inf
    assert radii(models, np.zeros((1, 2)))[0] == pytest.approx(1.1)


def test_descent_begins_with_a_law_that_is_unstable_on_some_and_ends_stable_on_all():
    """x+ = a x + b u of several a and b: u = -k x is stable for all where |a - b k| < 1."""
    one = np.eye(1)
    pairs = [(1.6, 0.8), (1.6, 1.2), (1.2, 1.2)]
    models = Models.of([(a * one, b * one, one, one, one, 0 * one, one, 0 * one, one) for a, b in pairs])
    theta, found = descend(models, np.zeros(1), free((1, 1)), np.ones(1))
    assert found.radii.max() < 1
    k = np.linspace(0.76, 2.1, 20001)  # J by its closed form: 2 (1 + k^2) / (1 - (a - b k)^2)
    with np.errstate(divide="ignore"):
        each = [np.where(np.abs(a - b * k) < 1, 2 * (1 + k**2) / (1 - (a - b * k) ** 2), np.inf) for a, b in pairs]
    whole = np.mean(each, axis=0)
    assert -theta[0] == pytest.approx(k[np.argmin(whole)], abs=0.02)
    assert found.cost == pytest.approx(whole.min(), rel=1e-4)

"""Covariances by their roots, against closed forms and SciPy."""

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.linalg import expm, solve_discrete_lyapunov

from pliant.controllers.estimation import square_root
from pliant.plants import PliantError


def test_triangle():
    M = np.random.default_rng(0).normal(size=(3, 2))
    S = square_root.triangle(M)
    np.testing.assert_allclose(S @ S.T, M @ M.T, atol=1e-14)
    assert (np.diag(S) >= 0).all() and np.allclose(S, np.tril(S))


def test_update_is_the_formula_with_an_inverse():
    rng = np.random.default_rng(1)
    state, own = np.hstack([rng.normal(size=(3, 3)), np.zeros((3, 2))]), np.eye(2)
    reading = np.hstack([rng.normal(size=(2, 3)), own])
    L, root, innovation = square_root.update(state, reading)
    P, S, M = state @ state.T, reading @ reading.T, state @ reading.T
    np.testing.assert_allclose(L, M @ np.linalg.inv(S), atol=1e-12)
    np.testing.assert_allclose(root @ root.T, P - M @ np.linalg.inv(S) @ M.T, atol=1e-12)
    np.testing.assert_allclose(innovation @ innovation.T, S, atol=1e-12)


def test_stein():
    rng = np.random.default_rng(2)
    F, J = rng.normal(size=(4, 4)), rng.normal(size=(4, 2))
    F *= 0.99 / np.abs(np.linalg.eigvals(F)).max()
    S = square_root.stein(F, J)
    right = solve_discrete_lyapunov(F, J @ J.T)
    np.testing.assert_allclose(S @ S.T, right, atol=1e-11 * np.abs(right).max())
    with pytest.raises(PliantError, match="does not decay"):
        square_root.stein(np.eye(1), np.eye(1))


@pytest.mark.parametrize("index", [1.0, 1e5, 1e10])
def test_a_tracker_with_sensors_far_better_than_its_noise(index):
    """Kalata's tracking index (1984), acceleration held in each T: with r = 4/(4 + i + sqrt(8 i + i^2)),
    P = v^2 [[1 - r^2, 2 (1 - r)^2/T], [., 4 (1 - r)^3/(r T^2)]]. A rounding of a root that is i times v is i eps of it.
    """
    T, v = 0.5, 1e-5
    r = 4 / (4 + index + np.sqrt(8 * index + index**2))
    A, C = np.array([[1.0, T], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    noise = np.hstack([index * v / T**2 * np.array([[T**2 / 2], [T]]), np.zeros((2, 1))])
    read = np.hstack([C @ noise[:, :1], [[v]]])
    near = square_root.update(np.hstack([1e3 * np.eye(2), noise]), np.hstack([1e3 * C, read]))[1]
    S = square_root.steady(A, C, noise, read, near)
    right = np.array([[1 - r**2, 2 * (1 - r) ** 2 / T], [2 * (1 - r) ** 2 / T, 4 * (1 - r) ** 3 / (r * T**2)]])
    np.testing.assert_allclose(S @ S.T, right * v**2, rtol=300 * 2.3e-16 * max(index, 10.0))


@pytest.mark.parametrize("samples", [3, 6, 40])
def test_white_noise_is_integrated_over_the_period(samples):
    """An oscillator sampled a few times a period, by quadrature of e^(As) E W E' e^(A's) (Van Loan 1978)."""
    w, W = 2 * np.pi, np.array([[0.7]])
    A, E, dt = np.array([[0.0, 1.0], [-(w**2), -0.02 * w]]), np.array([[0.0], [1.0]]), 1 / samples
    G, rest, mean = square_root.white(A, E, W, dt)
    right = quad_vec(lambda s: expm(A * s) @ E @ W @ E.T @ expm(A.T * s), 0, dt, epsrel=1e-12)[0]
    held = quad_vec(lambda s: expm(A * s) @ E, 0, dt, epsrel=1e-12)[0]
    np.testing.assert_allclose(G @ mean @ G.T + rest @ rest.T, right, rtol=1e-10)
    np.testing.assert_allclose(G, held, rtol=1e-10)
    np.testing.assert_allclose(mean, W / dt, rtol=1e-14)
    trace = (right[0, 0] + right[1, 1] / w**2) / (held @ W @ held.T / dt * np.diag([1, w**-2.0])).trace()
    assert {3: 1.4, 6: 1.05, 40: 1.0}[samples] < trace  # what held noise of the same density has too little


def test_white_noise_on_a_stiff_and_a_free_state():
    """x' = -1e8 x + w: W/2e8; of its double integral, W dt^3/3; in states of any unit."""
    A = np.zeros((3, 3))
    A[0, 0], A[1, 2] = -1e8, 1e9
    E, dt = np.array([[1.0], [0.0], [1e-9]]), 0.1
    G, rest, mean = square_root.white(A, E, np.array([[2.0]]), dt)
    P = G @ mean @ G.T + rest @ rest.T
    np.testing.assert_allclose(np.diag(P), [1e-8, 2 * dt**3 / 3, 2e-18 * dt], rtol=1e-12)

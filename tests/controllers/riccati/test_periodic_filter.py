"""The periodic filter, held against SciPy's equation for a constant plant, a long recursion, and seeded runs."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from pliant.controllers.riccati import dpkalman
from pliant.plants.core.errors import UncontrollableError


def periodic(seed=0, N=5, nx=3, ny=2):
    rng = np.random.default_rng(seed)
    A, C = 0.7 * rng.standard_normal((N, nx, nx)), rng.standard_normal((N, ny, nx))
    root = rng.standard_normal((N, nx, nx))
    return A, C, root @ root.transpose(0, 2, 1), np.diag([0.5, 2.0])


def test_of_a_constant_plant_it_is_scipys():
    A, C = np.array([[1.0, 0.1], [-0.4, 0.95]]), np.array([[1.0, 0.0]])
    W, V = np.diag([0.01, 0.2]), np.array([[0.3]])
    found = dpkalman(np.tile(A, (4, 1, 1)), np.tile(C, (4, 1, 1)), W, V)
    S = solve_discrete_are(A.T, C.T, W, V)
    assert found.before == pytest.approx(np.tile(S, (4, 1, 1)), rel=1e-9)
    assert pytest.approx(np.tile(S @ C.T / (C @ S @ C.T + V), (4, 1, 1)), rel=1e-9) == found.L


def test_it_is_where_a_long_recursion_ends():
    """The textbook's recursion, in other words: information form of the update (Anderson and Moore, Section 6.3)."""
    A, C, W, V = periodic()
    S, found = np.eye(3), dpkalman(A, C, W, V)
    for k in range(500):
        after = np.linalg.inv(np.linalg.inv(S) + C[k % 5].T @ np.linalg.inv(V) @ C[k % 5])
        if k >= 495:
            assert found.before[k % 5] == pytest.approx(S, rel=1e-8, abs=1e-12)
            assert found.after[k % 5] == pytest.approx(after, rel=1e-8, abs=1e-12)
        S = A[k % 5] @ after @ A[k % 5].T + W[k % 5]


def test_the_covariance_is_what_seeded_runs_see():
    A, C, W, V = periodic(2)
    found, rng, runs = dpkalman(A, C, W, V), np.random.default_rng(0), 20_000
    e = np.zeros((runs, 3))
    for k in range(40):
        v = rng.standard_normal((runs, 2)) * np.sqrt(np.diag(V))
        e = e - (e @ C[k % 5].T + v) @ found.L[k % 5].T
        seen = e.T @ e / runs
        e = e @ A[k % 5].T + rng.standard_normal((runs, 3)) @ np.linalg.cholesky(W[k % 5]).T
    assert seen == pytest.approx(found.after[4], rel=0.05, abs=0.05 * np.abs(found.after[4]).max())


def test_what_is_not_seen_or_not_a_covariance_is_refused():
    A, C = np.tile(np.eye(2), (3, 1, 1)), np.tile([[1.0, 0.0]], (3, 1, 1))
    with pytest.raises(UncontrollableError, match="the readings do not see it"):
        dpkalman(A, C, np.eye(2), np.eye(1))
    with pytest.raises(ValueError, match="must be > 0"):
        dpkalman(A, C, np.eye(2), -np.eye(1))

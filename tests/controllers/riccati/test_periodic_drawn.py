"""The periodic regulator of what is drawn, held against the one that is known, De Koning's scalar, and a simulation."""

import numpy as np
import pytest

from pliant.controllers.riccati import dplqr
from pliant.controllers.riccati.periodic_drawn import drawn_periodic, multipliers_of
from pliant.plants.core.errors import PliantError


def problem(seed, m=1, N=4, nz=3, nu=1):
    rng = np.random.default_rng(seed)
    A, B = 0.6 * rng.standard_normal((m, N, nz, nz)), rng.standard_normal((m, N, nz, nu))
    root = rng.standard_normal((m, N, nz + nu, nz + nu))
    W = root.transpose(0, 1, 3, 2) @ root + 0.1 * np.eye(nz + nu)
    return np.concatenate([A, B], axis=3), W, rng.standard_normal((m, N, nz + nu))


def test_one_draw_is_the_known_system():
    F, W, g = problem(0)
    made = drawn_periodic(F, W, g)
    A, B, Q, R, N = F[0, :, :, :3], F[0, :, :, 3:], W[0, :, :3, :3], W[0, :, 3:, 3:], W[0, :, :3, 3:]
    known = dplqr(A, B, Q, R, N, q=g[0, :, :3], s=g[0, :, 3:])
    for found, wanted in ((made.K, known.K), (made.k, known.k), (made.P, known.P), (made.p, known.p)):
        assert found == pytest.approx(wanted, rel=1e-8, abs=1e-9)
    assert pytest.approx(known.S, rel=1e-8) == made.S
    assert multipliers_of(F, made.K)[0] == pytest.approx(known.multipliers, rel=1e-6, abs=1e-12)


def test_a_scalar_that_is_drawn_has_a_closed_form():
    """x+ = a x + b u, a of mean 1 and variance v: P = 1 + (1 + v) P - P^2 / (1 + P), a quadratic."""
    v = 0.2
    F = np.array([[1 + np.sqrt(v), 1.0], [1 - np.sqrt(v), 1.0]]).reshape(2, 1, 1, 2)
    made = drawn_periodic(F, np.tile(np.eye(2), (2, 1, 1, 1)), np.zeros((2, 1, 2)))
    a, b, c = v - 1, 1 + v, 1.0  # (v - 1) P^2 + (1 + v) P + 1 = 0
    P = (-b - np.sqrt(b * b - 4 * a * c)) / (2 * a)
    assert made.P[0, 0, 0] == pytest.approx(P, rel=1e-10)
    assert made.K[0, 0, 0] == pytest.approx(P / (1 + P), rel=1e-10)


def test_the_mean_cost_is_what_the_cost_to_go_says():
    """z'P z over 4000 seeded runs; of a gain beside the law it is dearer."""
    F, W, _ = problem(3, m=2, N=3)
    made, rng, z0 = drawn_periodic(F, W, np.zeros((2, 3, 4))), np.random.default_rng(1), np.array([1.0, -1.0, 0.5])

    def mean(K):
        z, total = np.tile(z0, (4000, 1)), np.zeros(4000)
        for k in range(60):
            pick, j = rng.integers(0, 2, len(z)), k % 3
            both = np.concatenate([z, -z @ K[j].T], axis=1)
            total += np.einsum("bi,bij,bj->b", both, W[pick, j], both)
            z = np.einsum("bij,bj->bi", F[pick, j], both)
        return total.mean(), 4 * total.std() / np.sqrt(len(total))

    wanted = z0 @ made.P[0] @ z0
    found, within = mean(made.K)
    assert abs(found - wanted) < within
    assert mean(1.3 * made.K)[0] > found


def test_what_no_gain_bears_is_refused():
    F = np.array([[4.0, 1.0], [-4.0, 1.0]]).reshape(2, 1, 1, 2)
    with pytest.raises(PliantError, match="no solution"):
        drawn_periodic(F, np.tile(np.eye(2), (2, 1, 1, 1)), np.zeros((2, 1, 2)))
    with pytest.raises(ValueError, match="W has an eigenvalue"):
        drawn_periodic(F, np.tile(-np.eye(2), (2, 1, 1, 1)), np.zeros((2, 1, 2)))
    with pytest.raises(ValueError, match="F has shape"):
        drawn_periodic(np.zeros((1, 1, 2, 2)), np.zeros((1, 1, 2, 2)), np.zeros((1, 1, 2)))

"""The bound on a transition matrix against SciPy's exponentials of what A(t) may have been between its nodes."""

import numpy as np
import pytest
from scipy.linalg import expm

from pliant.plants.transitions.state_matrix_path import Path
from pliant.plants.transitions.transition_error import _higher, monodromy, transition


def switched(rng, n=3):
    mean, pump = rng.standard_normal((2, n, n))
    return mean - 0.5 * np.eye(n), pump * (rng.uniform(size=(n, n)) < 0.5)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("m", (12, 60, 400))
def test_every_place_of_a_jump_is_covered(seed, m):
    """A(t) jumps once between two nodes, at any share of the interval; first and higher orders, entry by entry."""
    mean, pump = switched(np.random.default_rng(seed))
    t, k = np.linspace(0.0, 1.0, m + 1), m // 3
    sign = np.where(np.arange(m + 1) <= k, 1.0, -1.0)
    found = transition([Path(t, mean + sign[:, None, None] * pump, np.ones(3))])
    for share in (1e-9, 0.25, 0.5, 0.75, 1 - 1e-9):
        at = t[k] + share * (t[k + 1] - t[k])
        true = expm((mean - pump) * (1 - at)) @ expm((mean + pump) * at)
        assert (np.abs(true - found.M) <= found.D).all()
        assert abs(np.trace(true - found.M)) <= found.trace.sum() <= np.trace(found.D) * (1 + 1e-9)
    rate = np.trace(mean) + np.trace(pump) * (2 * t[k] + 1 / m - 1)
    assert abs(found.rate.sum() - rate) < 1e-12
    assert found.rate_error.sum() >= abs(np.trace(pump)) / m


@pytest.mark.parametrize("seed", range(3))
def test_jumps_of_the_state_and_pieces(seed):
    rng = np.random.default_rng(seed)
    A, B = rng.standard_normal((2, 3, 3))
    J = rng.standard_normal((3, 3))
    paths = [
        Path(np.array([0.0, 0.4]), A[None].repeat(2, 0), np.ones(3)),
        Path(np.array([0.4, 1.0]), B[None].repeat(2, 0), np.ones(3)),
    ]
    found = transition(paths, [J])
    wanted = expm(0.6 * B) @ J @ expm(0.4 * A)
    np.testing.assert_allclose(found.M, wanted, atol=1e-13)
    assert (np.abs(found.M - wanted) <= found.D + 1e-15).all() and found.D.max() < 1e-13
    product = np.eye(3)
    for Phi in found.Phi:
        product = Phi @ product
    np.testing.assert_allclose(product, wanted, atol=1e-13)


@pytest.mark.parametrize("error", (0.1, 1.0, 3.0))
@pytest.mark.parametrize("m", (8, 64))
def test_higher_orders_in_closed_form(error, m):
    """x' = a x with a + e in place of a: e^a (e^e - 1) in all, e^a e of the first order."""
    a, one = -0.7, np.ones((m, 1, 1))
    t = np.arange(m + 1)[:, None, None] / m
    F, B = np.exp(a * t), np.exp(a * (1 - t))
    rest = _higher(np.exp(a / m) * one, error / m * one, np.maximum(F[:-1], F[1:]), np.maximum(B[:-1], B[1:]))
    exact = np.exp(a) * (np.expm1(error) - error)
    assert exact <= rest[0, 0] < (1.3 if m == 64 else 4) * exact


def test_zeros_that_are_meant_stay_zero():
    """A triangular A has a triangular transition, and nothing is open below its diagonal."""
    t = np.linspace(0.0, 1.0, 31)
    A = np.zeros((31, 3, 3))
    A[:, 0, 1], A[:, 1, 2], A[:, 0, 0] = np.cos(7 * t), np.where(t < 0.5, 1.0, 2.0), -1.0
    found = transition([Path(t, A, np.ones(3))])
    assert not np.tril(found.D, -1).any() and (found.D[0, 1:] > 0).all()


def test_steps_are_halved_no_further_than_the_data_deserve():
    t = np.linspace(0.0, 1.0, 41)
    A = np.zeros((41, 2, 2))
    A[:, 0, 1], A[:, 1, 0] = 1.0, -40 * np.where(t < 0.5, 1.0, 2.0)
    rough = transition([Path(t, A, np.ones(2))])
    assert rough.steps <= 80
    smooth = A.copy()
    smooth[:, 1, 0] = -40 * (1 + 0.5 * np.cos(2 * np.pi * t))
    path = Path(t, smooth, np.ones(2), periodic=True)
    fine = transition([path])
    _, M, error = monodromy(path, 1.0, 1e-11)
    assert (np.abs(fine.M - M) <= fine.D + error * np.abs(M).max()).all() and fine.D.max() < 1e-9


def test_beyond_the_range_of_numbers_nothing_is_known():
    t = np.linspace(0.0, 1.0, 11)
    A = np.full((11, 1, 1), 2000.0) + t[:, None, None]
    assert not np.isfinite(transition([Path(t, A, np.ones(1))]).D).all()


@pytest.mark.parametrize("seed", range(4))
def test_in_the_eigenvectors_coordinates_the_bound_holds_and_is_smaller(seed):
    """Every place of a jump again, now V^-1 (M' - M) V, for a fast mode in coordinates in which it is no rotation."""
    rng = np.random.default_rng(seed)
    S = np.linalg.qr(rng.standard_normal((4, 4)))[0] @ np.diag([1.0, 20.0, 1.0, 5.0])
    mean = np.zeros((4, 4))
    mean[:2, :2], mean[2:, 2:] = [[-0.1, 40.0], [-40.0, -0.1]], [[-0.05, 2.0], [-2.0, -0.05]]
    mean, pump = S @ mean @ np.linalg.inv(S), 0.05 * S @ rng.standard_normal((4, 4)) @ np.linalg.inv(S)
    t, k = np.linspace(0.0, 1.0, 61), 20
    sign = np.where(np.arange(61) <= k, 1.0, -1.0)
    found = transition([Path(t, mean + sign[:, None, None] * pump, np.ones(4))], modal=True)
    W = np.linalg.inv(found.V)
    np.testing.assert_allclose(found.M_V, W @ found.M @ found.V, atol=1e-10)
    for share in (1e-9, 0.25, 0.5, 0.75, 1 - 1e-9):
        at = t[k] + share * (t[k + 1] - t[k])
        true = expm((mean - pump) * (1 - at)) @ expm((mean + pump) * at)
        assert (np.abs(W @ true @ found.V - found.M_V) <= found.D_V).all()
    assert found.D_V.max() < 0.2 * (np.abs(W) @ found.D @ np.abs(found.V)).max()

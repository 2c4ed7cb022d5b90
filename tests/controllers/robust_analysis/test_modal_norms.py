"""Norms that follow the modes of a few matrices."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from pliant.controllers.robust_analysis.modal_norms import _matched, lyapunov_norms, modal_norms


def turned(angle, radius=0.95):
    c, s = np.cos(angle), np.sin(angle)
    V = np.array([[1.0, 0.3], [-200.0, 50.0]])
    return radius * V @ np.array([[c, -s], [s, c]]) @ np.linalg.inv(V)


def test_a_mode_that_only_turns_faster_keeps_its_norm():
    A = np.array([turned(a) for a in (0.3, 0.2, 0.5)])
    found = modal_norms(A, 0.999)
    np.testing.assert_allclose(found.own, np.tile(np.eye(2), (2, 1, 1)), atol=1e-10)
    np.testing.assert_allclose(found.T @ found.inverse, np.eye(2), atol=1e-12)
    falls = np.linalg.norm(found.T @ A @ found.inverse, 2, axis=(1, 2))
    np.testing.assert_allclose(falls, 0.95, rtol=1e-10)
    assert np.linalg.norm(lyapunov_norms(A, 0.5).T @ A[2] @ lyapunov_norms(A, 0.5).inverse, 2) > 0.97


@pytest.mark.parametrize("of", [lambda A: modal_norms(A, 0.6), lambda A: lyapunov_norms(A, 0.3)])
def test_every_norm_is_of_its_own_matrix(of):
    rng = np.random.default_rng(1)
    A = rng.normal(size=(6, 6))
    A = A / np.abs(np.linalg.eigvals(A)).max() * 0.9 + 0.003 * rng.normal(size=(5, 6, 6))
    found = of(A)
    for own, c in zip(found.own, A[1:]):
        moved = found.T @ c @ found.inverse
        assert np.linalg.eigvalsh(own)[0] > 0
        assert np.linalg.eigvalsh(own - moved.T @ own @ moved)[0] > 0  # x' P_c x falls


def test_modes_that_are_nearly_one_share_a_norm():
    """Their eigenvectors, nearly one, would take 1e6 of the state for nothing."""
    A = np.array([[[0.5, 1.0], [d, 0.5]] for d in (1e-12, 0.0, 2e-12)])
    assert modal_norms(A, 0.6) is None  # exactly one: no eigenvectors at all
    found = modal_norms(A[::2], 0.6)
    assert np.linalg.norm(found.T @ A[2] @ found.inverse, 2) < 0.9
    alone = modal_norms(A[::2], 1.5)
    assert np.linalg.norm(alone.own[0] - np.eye(2), 2) > 0.3  # they turn by much where matrices change by 1e-12


def test_rows_are_matched_as_scipy_does():
    rng = np.random.default_rng(5)
    for k in range(40):
        alike = rng.uniform(size=(4, 4)) + (k % 2) * 3.0 * np.eye(4)[rng.permutation(4)]
        np.testing.assert_array_equal(_matched(alike), linear_sum_assignment(-alike)[1])
    np.testing.assert_array_equal(_matched(np.ones((3, 3))), linear_sum_assignment(-np.ones((3, 3)))[1])

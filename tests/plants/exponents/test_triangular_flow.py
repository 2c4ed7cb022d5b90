"""Triangular form by QR, held against closed forms."""

import numpy as np
import pytest
from known_systems import ltv

from pliant.plants.exponents.triangular_flow import ordered_schur, triangular_flow

T = np.linspace(0.0, 12.0, 601)


def diagonal(t):
    """Rates whose integrals are closed forms, the first larger on average."""
    return np.array([[0.3 + np.cos(t), 2 * np.sin(3 * t)], [0.0, -0.5 + 0.4 * np.cos(np.sqrt(2) * t)]])


def test_a_triangular_model_is_its_own_form(along):
    flow = triangular_flow(along(T, diagonal))
    closed = np.column_stack([0.3 * T + np.sin(T), -0.5 * T + 0.4 * np.sin(np.sqrt(2) * T) / np.sqrt(2)])
    assert np.abs(flow.logs - closed).max() < 1e-7
    assert np.abs(np.abs(flow.Q) - np.eye(2)).max() < 1e-12


def test_sums_of_rates_are_the_trace_in_any_coordinates(along):
    S = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, 1.0]])

    def A(t):
        D = np.diag([np.sin(t), -1.0 + np.cos(2 * t), 0.2])
        return S @ D @ np.linalg.inv(S)

    flow = triangular_flow(along(T, A))
    assert flow.logs.sum(axis=1) == pytest.approx(1 - np.cos(T) - T + np.sin(2 * T) / 2 + 0.2 * T, abs=1e-6)
    for Q, R, following in zip(flow.Q, flow.R, flow.Q[1:]):
        assert np.abs(Q.T @ Q - np.eye(3)).max() < 1e-12 and np.abs(np.tril(R, -1)).max() < 1e-12
        assert np.abs(following.T @ following - np.eye(3)).max() < 1e-12


def test_steklov_averages_and_blocks(along):
    flow = triangular_flow(along(T, diagonal))
    window = 2 * np.pi
    assert flow.steklov(window)[:, 0] == pytest.approx(0.3, abs=1e-4)  # chords between nodes 0.02 s apart
    low, high = flow.block(0, 1, window)
    assert low == pytest.approx(0.3, abs=5e-3) and high == pytest.approx(0.3, abs=5e-3)


def test_a_block_that_turns_is_bounded_by_its_norm(along, turn):
    """A rotation with decay: every direction shrinks at 0.25 1/s, whatever the diagonal does meanwhile."""
    flow = triangular_flow(along(T, lambda t: np.array([[-0.25, -3.0], [3.0, -0.25]])))
    low, high = flow.block(0, 2, 4.0)
    assert low == pytest.approx(-0.25, abs=1e-9) and high == pytest.approx(-0.25, abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_schur_vectors_come_in_order(seed):
    A = np.random.default_rng(seed).standard_normal((6, 6))
    Q = ordered_schur(A)
    found = Q.T @ A @ Q
    wanted = np.sort(np.linalg.eigvals(A).real)[::-1]
    assert np.abs(Q.T @ Q - np.eye(6)).max() < 1e-12
    for k in range(1, 6):
        if wanted[k - 1] - wanted[k] > 1e-6:
            assert np.abs(found[k:, :k]).max() < 1e-10
            assert np.sort(np.linalg.eigvals(found[:k, :k]).real)[::-1] == pytest.approx(wanted[:k], abs=1e-8)


def test_a_block_of_all_is_the_transition_matrix(along):
    """Its least and largest rate over the record are those of the product of all steps."""
    M, N = np.random.default_rng(4).standard_normal((2, 3, 3))
    flow = triangular_flow(along(np.linspace(0, 2, 101), lambda t: M + np.sin(3 * t) * N))
    total = np.eye(3)
    for R in flow.R:
        total = R @ total
    sizes = np.log(np.linalg.svd(total, compute_uv=False)) / 2
    assert flow.block(0, 3, 2.0) == pytest.approx((sizes[-1], sizes[0]), abs=1e-9)


def test_smooth_averages_are_those_of_a_sin_squared_window():
    """Of cos(w t) over L from s on: cos(w (s + L/2)) sin(x) / (x (1 - (x/pi)^2)), x = w L/2, in closed form."""
    t, w, L = np.linspace(0.0, 10.0, 4001), 7.0, 6.0
    flow = triangular_flow(ltv(t, (0.3 + np.cos(w * t))[:, None, None]))
    begin, x = np.linspace(0.0, 4.0, len(flow.smooth(L))), w * L / 2
    wanted = 0.3 + np.cos(w * (begin + L / 2)) * np.sin(x) / (x * (1 - (x / np.pi) ** 2))
    np.testing.assert_allclose(flow.smooth(L)[:, 0], wanted, atol=2e-6)

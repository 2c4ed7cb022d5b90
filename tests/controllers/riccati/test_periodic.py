"""The periodic regulator, held against a long horizon by brute force, and against the constant one."""

import numpy as np
import pytest

from pliant.controllers.riccati import dlqr, dplqr, dtvlqr
from pliant.plants import UncontrollableError


@pytest.fixture
def system():
    """Random steps, some of which grow, with all terms."""

    def made(seed, T=7, nx=4, nu=2):
        rng = np.random.default_rng(seed)
        A = rng.standard_normal((T, nx, nx)) * 0.7
        B = rng.standard_normal((T, nx, nu))
        root = rng.standard_normal((T, nx + nu, nx + nu))
        W = root @ root.transpose(0, 2, 1) / 4 + 0.1 * np.eye(nx + nu)
        linear = {name: 0.3 * rng.standard_normal((T, n)) for name, n in (("c", nx), ("q", nx), ("s", nu))}
        return A, B, W[:, :nx, :nx], W[:, nx:, nx:], W[:, :nx, nx:], linear

    return made


@pytest.mark.parametrize("seed", range(8))
def test_a_long_horizon_ends_in_it(system, seed):
    """Thirty periods backwards by `dtvlqr`, by other means (square roots): the same gains, costs and offsets."""
    A, B, Q, R, N, linear = system(seed)
    found = dplqr(A, B, Q, R, N, **linear)
    many = 30
    tiled = [np.tile(M, (many, 1, 1)) for M in (A, B, Q, R, N)]
    rows = {name: np.tile(v, (many, 1)) for name, v in linear.items()}
    size = np.array([np.abs(v).sum() for v in linear.values()]).sum() * 1e3  # a constant keeps the whole cost >= 0
    long = dtvlqr(*tiled, **rows, r=np.full(many * len(A), size))
    assert pytest.approx(long.K[: len(A)], rel=1e-8, abs=1e-8) == found.K
    assert pytest.approx(long.P[: len(A)], rel=1e-8, abs=1e-8) == found.P
    assert found.k == pytest.approx(long.k[: len(A)], rel=1e-6, abs=1e-6)
    assert np.abs(found.multipliers[0]) < 1 and found.residual < 1e-12


def test_the_orbit_is_the_one_of_least_mean_cost(system):
    """A periodic orbit by direct minimisation of the same sum over x_0 and all u."""
    A, B, Q, R, N, linear = system(3, T=5)
    found = dplqr(A, B, Q, R, N, **linear)
    T, nx, nu = len(A), A.shape[1], B.shape[2]

    def affine(z):
        """x (T + 1, nx) of z = [x_0; u_0 .. u_T-1]."""
        x, u = [z[:nx]], z[nx:].reshape(T, nu)
        for k in range(T):
            x.append(A[k] @ x[-1] + B[k] @ u[k] + linear["c"][k])
        return np.array(x), u

    base, _ = affine(np.zeros(nx + T * nu))
    slopes = np.array([(affine(e)[0] - base).ravel() for e in np.eye(nx + T * nu)]).T
    H, g = np.zeros((nx + T * nu,) * 2), np.zeros(nx + T * nu)
    for k in range(T):
        J = np.vstack([slopes[k * nx : (k + 1) * nx], np.zeros((nu, nx + T * nu))])
        J[nx:, nx + k * nu : nx + (k + 1) * nu] = np.eye(nu)
        W = np.block([[Q[k], N[k]], [N[k].T, R[k]]])
        at = np.concatenate([base[k], np.zeros(nu)])
        H, g = H + J.T @ W @ J, g + J.T @ (W @ at + np.concatenate([linear["q"][k], linear["s"][k]]))
    closes = slopes[T * nx :].copy()
    closes[:, :nx] -= np.eye(nx)
    kkt = np.block([[H, closes.T], [closes, np.zeros((nx, nx))]])
    z = np.linalg.solve(kkt, np.concatenate([-g, -base[T]]))[: nx + T * nu]
    x, u = affine(z)
    assert found.orbit == pytest.approx(x[:-1], abs=1e-9)
    assert -np.einsum("kij,kj->ki", found.K, found.orbit) - found.k == pytest.approx(u, abs=1e-9)


def test_a_constant_system_has_the_constant_regulator(system):
    A, B, Q, R, N, _ = (M[0] if isinstance(M, np.ndarray) else M for M in system(1))
    still = dlqr(A, B, Q, R, N)
    found = dplqr(np.tile(A, (6, 1, 1)), np.tile(B, (6, 1, 1)), Q, R, N)
    assert pytest.approx(np.tile(still.P, (6, 1, 1)), rel=1e-10) == found.P
    assert np.sort(np.abs(found.multipliers)) == pytest.approx(np.sort(np.abs(still.poles) ** 6), rel=1e-6, abs=1e-12)


def test_slow_modes_cost_no_more():
    """A rotation by little at a time, hardly damped, and an integrator that the cost hardly sees."""
    c, s = np.cos(0.01), np.sin(0.01)
    A = np.tile(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), (10, 1, 1))
    B = np.tile(np.array([[0.0], [1e-3], [1e-3]]), (10, 1, 1))
    found = dplqr(A, B, 1e-4 * np.eye(3), np.eye(1))
    assert 0.99 < np.abs(found.multipliers[0]) < 1 and found.residual < 1e-9


def test_what_no_gain_steers_or_no_cost_sees_is_refused():
    A, B = np.tile(np.diag([1.1, 0.5]), (3, 1, 1)), np.tile([[0.0], [1.0]], (3, 1, 1))
    with pytest.raises(UncontrollableError, match="dplqr"):
        dplqr(A, B, np.eye(2), np.eye(1))
    A = np.tile(np.diag([1.0, 0.5]), (3, 1, 1))
    with pytest.raises(UncontrollableError, match="dplqr"):
        dplqr(A, np.tile([[1.0], [1.0]], (3, 1, 1)), np.diag([0.0, 1.0]), np.eye(1))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"R": -np.eye(1)}, "R has an eigenvalue that is not > 0"),
        ({"Q": -np.eye(2)}, "must be >= 0"),
        ({"A": np.zeros((0, 2, 2))}, "B has"),
    ],
)
def test_bad_input(change, words):
    given = {"A": np.zeros((2, 2, 2)), "B": np.ones((2, 2, 1)), "Q": np.eye(2), "R": np.eye(1)} | change
    with pytest.raises(ValueError, match=words):
        dplqr(**given)

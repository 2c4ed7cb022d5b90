"""Linear-quadratic design by algebraic Riccati equations: lqr, dlqr, lqi, sampled, kalman, dkalman; see the room.

Solved in even units and refined, see `scaled_equation`. A mode that does not decay must be reached by the input and
seen by the cost (Popov, Belevitch, Hautus); the error names the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_seconds
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.linear.even_units import even_units
from pliant.plants.linear.magnus import halvings, with_cost

from .checks import columns_even, sized
from .checks import known_names as _names
from .checks import require_reached as _require_reached
from .checks import system as _system
from .checks import weight_matrix as _weight
from .scaled_equation import Problem, solve_even


class Regulator(NamedTuple):
    """u = -K x."""

    K: np.ndarray  # (nu, nx)
    P: np.ndarray  # (nx, nx), x'P x is the cost to go
    poles: np.ndarray  # (nx,) eigenvalues of A - B K: [1/s], or in the z plane

    def cost_to_go(self, x: Any) -> float:
        """x'P x: what the law costs from x (nx,) on."""
        x = require_finite("x", x, (len(self.P),))
        return float(x @ self.P @ x)


class Sampled(NamedTuple):
    """x+ = A x + B u and the cost x'Qx + u'Ru + 2 x'Nu of one step. A, Q (nx, nx), B, N (nx, nu), R (nu, nu).

    Example
    -------
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> sampled(A, B, np.eye(2), np.eye(1), dt=0.1).A
    array([[1. , 0.1],
           [0. , 1. ]])
    """

    A: np.ndarray
    B: np.ndarray
    Q: np.ndarray
    R: np.ndarray
    N: np.ndarray


def lqr(A: Any, B: Any, Q: Any, R: Any, N: Any = None, *, names: Sequence[str] | None = None) -> Regulator:
    """Continuous-time regulator. A (nx, nx), B (nx, nu), Q (nx, nx) >= 0, R (nu, nu) > 0, N (nx, nu).

    Example
    -------
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> lqr(A, B, np.eye(2), np.eye(1)).K.round(4)
    array([[1.    , 1.7321]])
    """
    return _design(A, B, Q, R, N, names, None)


def dlqr(
    A: Any, B: Any, Q: Any, R: Any, N: Any = None, *, names: Sequence[str] | None = None, dt: float = 1.0
) -> Regulator:
    """Discrete-time regulator; A, B, Q, R, N as for `lqr`. `dt` [s] is used only to name modes in Hz in errors.

    Example
    -------
    >>> A, B = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.005], [0.1]])
    >>> dlqr(A, B, np.eye(2), np.eye(1)).K.round(4)
    array([[0.9171, 1.6356]])
    """
    return _design(A, B, Q, R, N, names, require_seconds("dt", dt))


def lqi(A: Any, B: Any, C: Any, Q: Any, R: Any, *, D: Any = None, names: Sequence[str] | None = None) -> Regulator:
    """Regulator with integral action on y = C x + D u: states [x, int y], Q (nx + ny, nx + ny), R (nu, nu).

    Example
    -------
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> lqi(A, B, [[1.0, 0.0]], np.eye(3), np.eye(1)).K.shape
    (1, 3)
    """
    A, B = _system(A, B)
    C = require_finite("C", C, (-1, len(A)))
    D = np.zeros((len(C), B.shape[1])) if D is None else require_finite("D", D, (len(C), B.shape[1]))
    known = _names(names, len(A)) + tuple(f"integral {i + 1}" for i in range(len(C)))
    return lqr(*with_integrals(A, B, C, D), Q, R, names=known)


def with_integrals(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, dt: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """A (nx + ny, nx + ny), B (nx + ny, nu) of [x; int y], y = C x + D u; of x+ = A x + B u, [x; sum dt y]."""
    nx, ny = len(A), len(C)
    stay, rate = (np.zeros((ny, ny)), 1.0) if dt is None else (np.eye(ny), dt)
    return np.block([[A, np.zeros((nx, ny))], [rate * C, stay]]), np.vstack([B, rate * D])


def kalman(
    A: Any, E: Any, C: Any, W: Any, V: Any, *, names: Sequence[str] | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Steady filter gain L (nx, ny) and error covariance P (nx, nx).

    E (nx, nw), C (ny, nx); spectral densities W (nw, nw) >= 0 of w, V (ny, ny) > 0 of v, in unit^2 s.

    Example
    -------
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> L, P = kalman(A, B, [[1.0, 0.0]], np.eye(1), np.eye(1))
    >>> L.T.round(4)
    array([[1.4142, 1.    ]])
    """
    return _filter(A, E, C, W, V, names, None)


def dkalman(
    A: Any, E: Any, C: Any, W: Any, V: Any, *, names: Sequence[str] | None = None, dt: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Steady predictor gain L (nx, ny) and covariance P (nx, nx) of the error before the measurement: the dual of
    dlqr.

    E (nx, nw), C (ny, nx); covariances W (nw, nw) >= 0 and V (ny, ny) > 0 of a sample of w and v. The gain of the
    measurement update is M = P C' (C P C' + V)^-1, so that L = A M. `dt` [s] only names modes in Hz in errors.

    Example
    -------
    >>> A, B = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.005], [0.1]])
    >>> L, P = dkalman(A, B, [[1.0, 0.0]], np.eye(1), np.eye(1))
    >>> L.shape, P.shape
    ((2, 1), (2, 2))
    """
    return _filter(A, E, C, W, V, names, require_seconds("dt", dt))


def _filter(
    A: Any, E: Any, C: Any, W: Any, V: Any, names: Sequence[str] | None, dt: float | None
) -> tuple[np.ndarray, np.ndarray]:
    A, E = _system(A, E, "E")
    C = require_finite("C", C, (-1, len(A)))
    W = _weight("W", W, E.shape[1], definite=False)
    V = _weight("V", V, len(C), definite=True)
    words = "cannot be seen by the output", "is not driven by the noise w"
    known, drive = _names(names, len(A)), E @ semidefinite_root(W)
    return filter_gain(A, C, E @ W @ E.T, V, np.zeros((len(A), len(C))), drive, known, dt, words)


def filter_gain(
    A: np.ndarray,
    C: np.ndarray,
    W: np.ndarray,
    V: np.ndarray,
    N: np.ndarray,
    drive: np.ndarray,
    names: tuple[str, ...],
    dt: float | None,
    words: tuple[str, str],
    *,
    doubted: bool = True,
) -> tuple[np.ndarray, np.ndarray]:
    """L (nx, ny) and P (nx, nx) of every steady filter: noise W (nx, nx) on the state, V (ny, ny) on the reading
    C x, N (nx, ny) common to both.

    drive (nx, .): a root of W - N V^-1 N', what the reading does not tell of the noise. words: what
    UncontrollableError says of modes that do not decay and that C does not see, or that nothing drives. doubted: as in
    `solve_even`.
    """
    problem = Problem(A.T, C.T, W, V, N)
    x, u = problem.units()
    even = problem.scaled(x, u)
    _require_reached(even.A, columns_even(even.B), names, dt, words[0], dual=True)
    _require_reached((even.A - even.B @ even.lean()).T, x[:, None] * drive, names, dt, words[1])
    P, K = solve_even(even, x, u, dt, doubted=doubted)
    return K.T, P


def sampled(A: Any, B: Any, Q: Any, R: Any, N: Any = None, *, dt: float) -> Sampled:
    """The exact discrete problem of a continuous one with u held over each step dt [s].

    The cost of a step is int_0^dt z' M z, z = e^(F s) [x; u], F = [[A, B], [0, 0]], M = [[Q, N], [N', R]].
    It is found on dt/2^j by the exponential of Van Loan (1978), then doubled j times, which stays accurate
    for stiff A.

    Example
    -------
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> sampled(A, B, np.eye(2), np.eye(1), dt=0.1).B.round(4).T
    array([[0.005, 0.1  ]])
    """
    A, B = _system(A, B)
    dt = require_seconds("dt", dt)
    nx, nu = B.shape
    N = np.zeros((nx, nu)) if N is None else sized("N", N, (nx, nu))
    Q, R = sized("Q", Q, (nx, nx)), sized("R", R, (nu, nu))
    F = np.vstack([np.hstack([A, B]), np.zeros((nu, nx + nu))])
    M = np.block([[Q, N], [N.T, R]])
    F, M = F * dt, M * dt
    unit = even_units(F, np.zeros(nx + nu), np.diagonal(M))
    ratio, weight = unit[None, :] / unit[:, None], unit[:, None] * unit
    F, M = F * ratio, M * weight
    step, cost = with_cost(F, M, -F.T, halvings(F[:nx]))
    step, cost = step / ratio, (cost + cost.T) / 2 / weight
    return Sampled(step[:nx, :nx], step[:nx, nx:], cost[:nx, :nx], cost[nx:, nx:], cost[:nx, nx:])


def _design(A: Any, B: Any, Q: Any, R: Any, N: Any, names: Sequence[str] | None, dt: float | None) -> Regulator:
    A, B = _system(A, B)
    nx, nu = B.shape
    known = _names(names, nx)
    Q, R = _weight("Q", Q, nx, definite=False), _weight("R", R, nu, definite=True)
    N = np.zeros((nx, nu)) if N is None else sized("N", N, (nx, nu))
    if N.any():
        _weight("[[Q, N], [N', R]]", np.block([[Q, N], [N.T, R]]), nx + nu, definite=False)
    problem = Problem(A, B, Q, R, N)
    x, u = problem.units()
    even = problem.scaled(x, u)
    _require_reached(even.A, columns_even(even.B), known, dt, "cannot be reached by the input")
    lean = even.lean()
    seen = semidefinite_root(even.Q - even.N @ lean)
    _require_reached((even.A - even.B @ lean).T, seen, known, dt, "cannot be seen by the cost Q", dual=True)
    P, K = solve_even(even, x, u, dt)
    return Regulator(K, P, np.linalg.eigvals(A - B @ K).astype(complex))

"""The linear-quadratic regulator of a system that repeats after N steps, for ever.

dplqr   min of the mean over time of x'Qx + u'Ru + 2 x'Nu + 2 q'x + 2 s'u, x+ = A_k x + B_k u + c_k, all with period N

u = -K_k x - k_k. P_k is the stabilising solution of the periodic Riccati equation
P_k = Q + A'P A - (A'P B + N)(R + B'P B)^-1 (B'P A + N'), P = P_k+1 on the right, P_N = P_0. Steps are composed to one
period, and periods to many, in the form (A, G, H) that keeps both signs (structure-preserving doubling): quadratic
convergence however slow the slowest mode. q, s and c move the orbit: x = xi_k is the best one, of period N.

Source   Bittanti, Colaneri and De Nicolao, "The periodic Riccati equation", 1991; doubling: Chu, Fan, Lin, Wang 2004
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_finite
from pliant.plants.core.errors import PliantError, UncontrollableError

from .checks import indefinite

Array = np.ndarray
DOUBLINGS = 60
SETTLED, RESIDUAL = 1e-14, 1e-8  # change of P over a doubling, and what the equation may lack, relative
MARGIN = 1e-9  # by which a closed loop's multiplier has to be inside the unit circle


class PeriodicRegulator(NamedTuple):
    """u = -K_k x - k_k at the N steps of a period; cost to go beside the mean x'P_k x + 2 p_k'x."""

    K: Array  # (N, nu, nx)
    k: Array  # (N, nu)
    P: Array  # (N, nx, nx)
    p: Array  # (N, nx)
    orbit: Array  # (N, nx) xi_k: what the closed loop settles to
    multipliers: Array  # (nx,) of the closed loop over a period, largest first
    residual: float  # of the Riccati equation, relative
    S: Array  # (N, nu, nu): what v'S v an input v beside the law adds


def dplqr(
    A: Any, B: Any, Q: Any, R: Any, N: Any = None, c: Any = None, *, q: Any = None, s: Any = None
) -> PeriodicRegulator:
    """Discrete-time periodic regulator: A (N, nx, nx), B (N, nx, nu); Q, R, N, c, q, s with a leading N or the same at
    every step. The cost must be >= 0 in (x, u) and R > 0: ValueError names the step. UncontrollableError where no gain
    makes every deviation decay, or the cost does not see one that does not.

    Example
    -------
    >>> A, B = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.005], [0.1]])
    >>> dplqr(np.array([A, A]), np.array([B, 2 * B]), np.eye(2), np.eye(1)).K.shape
    (2, 1, 2)
    """
    A = require_finite("A", A, (-1, -1, -1))
    T, nx = A.shape[:2]
    A = require_finite("A", A, (T, nx, nx))
    B = require_finite("B", B, (-1, -1, -1))
    nu = B.shape[-1]
    B = require_finite("B", B, (T, nx, nu))
    if not T:
        raise ValueError("A has shape (0, ..), must have one step or more")
    Q, R = (_each(name, real_array(name, M), T, (n, n)) for name, M, n in (("Q", Q, nx), ("R", R, nu)))
    N = _each("N", N, T, (nx, nu))
    c, q, s = _each("c", c, T, (nx,)), _each("q", q, T, (nx,)), _each("s", s, T, (nu,))
    weight = np.concatenate([np.concatenate([Q, N], 2), np.concatenate([_t(N), R], 2)], 1)
    lacking = np.linalg.eigvalsh((R + _t(R)) / 2).min(axis=1, initial=np.inf) <= 0
    for sign, name, wrong in (("> 0", "R", lacking), (">= 0", "[[Q, N], [N', R]]", indefinite(weight, 1e-9))):
        if wrong.any():
            raise ValueError(
                f"step {int(np.argmax(wrong))}: {name} has an eigenvalue that is not {sign}, must be {sign}"
            )
    lean = np.linalg.solve(R, _t(N))
    P = _first(A - B @ lean, B @ np.linalg.solve(R, _t(B)), Q - N @ lean)
    found, gains, heavy = np.empty((T, nx, nx)), np.empty((T, nu, nx)), np.empty((T, nu, nu))
    later = P
    for _ in range(2):  # the second from where the first ended: what doubling rounded is gone
        for k in range(T - 1, -1, -1):
            heavy[k] = R[k] + B[k].T @ later @ B[k]
            gains[k] = np.linalg.solve(heavy[k], B[k].T @ later @ A[k] + N[k].T)
            loop = A[k] - B[k] @ gains[k]
            cost = Q[k] + gains[k].T @ R[k] @ gains[k] - N[k] @ gains[k] - gains[k].T @ N[k].T
            later = loop.T @ later @ loop + cost
            later = (later + later.T) / 2
            found[k] = later
        miss = float(np.abs(found[0] - P).max(initial=0.0) / max(np.abs(P).max(initial=0.0), 1e-300))
        P = found[0]
    if not miss <= RESIDUAL:
        raise PliantError(f"dplqr: the periodic Riccati equation is solved only to {miss:.2g}: scale the states")
    loops = A - B @ gains
    around = np.eye(nx)
    for loop in loops:
        around = loop @ around
    multipliers = np.linalg.eigvals(around)
    multipliers = multipliers[np.argsort(-np.abs(multipliers), kind="stable")]
    if nx and not np.abs(multipliers[0]) < 1 - MARGIN:
        size = float(np.abs(multipliers[0]))
        raise UncontrollableError(
            f"dplqr: a multiplier of the closed loop is {size:.9g}, must be below 1: a deviation that does not decay "
            "is not reached by the inputs, or not seen by the cost",
            (f"multiplier {size:.6g}",),
        )
    return _with_orbit(A, B, c, q, s, (gains, heavy, found, loops), (multipliers, miss))


def _first(A: Array, G: Array, H: Array) -> Array:
    """P_0 (n, n) from steps (A, G, H) (N, ..) without cross terms."""
    one = A[-1], G[-1], H[-1]
    for k in range(len(A) - 2, -1, -1):
        one = _composed((A[k], G[k], H[k]), one)
    for _ in range(DOUBLINGS):
        before = one[2]
        one = _composed(one, one)
        size = max(float(np.abs(one[2]).max(initial=0.0)), 1e-300)
        if not np.isfinite(size) or size > 1e200:
            break
        if np.abs(one[2] - before).max(initial=0.0) <= SETTLED * size:
            return one[2]
    if np.isfinite(one[2]).all() and np.abs(one[2] - before).max(initial=0.0) <= 1e-9 * size:
        return one[2]
    around = np.eye(A.shape[1])
    for step in A:
        around = step @ around
    modes = np.linalg.eigvals(around)
    raise UncontrollableError(
        "dplqr: no gain makes every deviation decay: one that grows is not reached by the inputs",
        tuple(f"multiplier {abs(z):.6g}" for z in modes if abs(z) >= 1),
    )


def _composed(first: tuple[Array, Array, Array], then: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
    """(A, G, H) of both steps: x+ = A (1 + G P+)^-1 x, cost to go P = H + A'P+ (1 + G P+)^-1 A."""
    (A1, G1, H1), (A2, G2, H2) = first, then
    one = np.eye(len(A1))
    ahead = np.linalg.solve(one + G1 @ H2, np.concatenate([A1, G1], axis=1))
    A, G = A2 @ ahead[:, : len(A1)], G2 + A2 @ ahead[:, len(A1) :] @ A2.T
    H = H1 + A1.T @ H2 @ ahead[:, : len(A1)]
    return A, (G + G.T) / 2, (H + H.T) / 2


def _with_orbit(
    A: Array, B: Array, c: Array, q: Array, s: Array, found: tuple[Array, ...], about: tuple[Array, float]
) -> PeriodicRegulator:
    """p from p_0 = M p_N + g with p_N = p_0, then the orbit in the same way."""
    K, heavy, P, loops = found
    T, nx = q.shape
    later = np.roll(P, -1, axis=0)
    forced = np.einsum("kij,kj->ki", later, c)

    def back(end: Array) -> tuple[Array, Array]:
        p, held = np.empty((T, nx)), np.empty(s.shape)
        for k in range(T - 1, -1, -1):
            v = forced[k] + end
            held[k] = np.linalg.solve(heavy[k], B[k].T @ v + s[k])
            end = q[k] + loops[k].T @ v - K[k].T @ s[k]
            p[k] = end
        return p, held

    def ahead(xi: Array, held: Array) -> Array:
        path = np.empty((T + 1, nx))
        path[0] = xi
        for k in range(T):
            path[k + 1] = loops[k] @ path[k] + c[k] - B[k] @ held[k]
        return path

    around = np.eye(nx)
    for loop in loops:
        around = loop @ around
    zero = np.zeros(nx)
    p, held = back(np.linalg.solve(np.eye(nx) - around.T, back(zero)[0][0]))
    orbit = ahead(np.linalg.solve(np.eye(nx) - around, ahead(zero, held)[-1]), held)[:-1]
    return PeriodicRegulator(K, held, P, p, orbit, *about, heavy)


def _each(name: str, value: Any, T: int, shape: tuple[int, ...]) -> Array:
    """A value of every step (T, *shape) from one for all, one each, or None for zero."""
    if value is None:
        return np.zeros((T, *shape))
    value = real_array(name, value)
    each = value.ndim == len(shape) + 1
    return np.array(np.broadcast_to(require_finite(name, value, (T, *shape) if each else shape), (T, *shape)))


def _t(M: Array) -> Array:
    return np.swapaxes(M, -1, -2)

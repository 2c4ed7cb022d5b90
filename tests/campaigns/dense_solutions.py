"""Linear-quadratic problems by ways of their own: doubling (Chu, Fan, Lin and Wang 2005), quadrature, least squares."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import scipy.linalg as sla
from random_loops import Array

from pliant.plants import PliantError


def doubled(A: Array, G: Array, H: Array) -> Array:
    """P = A'P (1 + G P)^-1 A + H."""
    for _ in range(60):
        W = np.linalg.inv(np.eye(len(A)) + G @ H)
        A, G, more = A @ W @ A, G + A @ W @ G @ A.T, A.T @ H @ W @ A
        H = H + (more + more.T) / 2
        if np.abs(more).max() <= 1e-16 * np.abs(H).max():
            return H
    raise PliantError("doubling does not end")


def doubled_precisely(A: Array, G: Array, H: Array) -> Array:
    """The same in 50 digits: doubling loses some where a filter trusts its readings far more than its model."""
    with mpmath.workdps(50):
        A, G, H = (mpmath.matrix(M.tolist()) for M in (A, G, (H + H.T) / 2))
        for _ in range(60):
            W = mpmath.inverse(mpmath.eye(len(A)) + G * H)
            more = A.T * H * W * A
            A, G, H = A * W * A, G + A * W * G * A.T, H + (more + more.T) / 2
            if mpmath.norm(more) <= mpmath.mpf(10) ** -40 * mpmath.norm(H):
                return np.array(H.tolist(), dtype=float)
    raise PliantError("doubling does not end")


def discrete(A: Array, B: Array, Q: Array, R: Array, N: Array, double: Any = doubled) -> tuple[Array, Array]:
    """K and P of the steady sampled regulator."""
    lean = np.linalg.solve(R, N.T)
    P = double(A - B @ lean, B @ np.linalg.solve(R, B.T), Q - N @ lean)
    return np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + N.T), P


def continuous(A: Array, B: Array, Q: Array, R: Array, double: Any = doubled) -> tuple[Array, Array]:
    """The same in continuous time, by Cayley's transform of the Hamiltonian matrix."""
    g, n = 1.1 * np.linalg.norm(A, 1) + 1, len(A)
    G = B @ np.linalg.solve(R, B.T)
    Ag = A - g * np.eye(n)
    W = np.linalg.inv(Ag.T + Q @ np.linalg.solve(Ag, G))
    start = np.eye(n) + 2 * g * W.T, 2 * g * np.linalg.solve(Ag, G) @ W, 2 * g * W @ Q @ np.linalg.inv(Ag)
    P = double(*start)
    return np.linalg.solve(R, B.T @ P), P


def filtered(E: Array, C: Array, drive: Array, noise: Array, double: Any = doubled) -> tuple[Array, Array]:
    """L and P after a sample, of x+ = E x + w, y = C x + v: covariance of w `drive`, deviations of v `noise`."""
    before, V = double(E.T, C.T @ np.diag(1 / noise**2) @ C, drive), np.diag(noise**2)
    L = np.linalg.solve(C @ before @ C.T + V, C @ before).T
    keep = np.eye(len(E)) - L @ C
    return L, keep @ before @ keep.T + L @ V @ L.T


def quadrature(A: Array, B: Array, weight: Array, dt: float) -> Array:
    """The integral over dt of F'weight F, F the motion of [x; u] with u held."""
    n, nu = B.shape
    big = np.block([[A, B], [np.zeros((nu, n + nu))]])
    parts = int(np.ceil(dt * np.linalg.norm(big, 2))) + 1
    at, share = np.polynomial.legendre.leggauss(10)
    total = np.zeros((n + nu, n + nu))
    for k in range(parts):
        for a, s in zip(at, share):
            F = sla.expm(dt * (k + (1 + a) / 2) / parts * big)
            total += s / 2 * dt / parts * F.T @ weight @ F
    return total


def random_steps(rng, T: int, n: int, nu: int) -> tuple[Array, Array, Array, Array]:
    """A, B, c and the weight of [x; u; 1] of T steps."""
    A = rng.standard_normal((T, n, n)) * rng.uniform(0.3, 1.2) / np.sqrt(n)
    root = rng.standard_normal((T, n + nu + 1, n + nu + 1))
    weight = root @ root.transpose(0, 2, 1) / (n + nu) + 0.1 * np.eye(n + nu + 1)
    return A, rng.standard_normal((T, n, nu)), rng.standard_normal((T, n)), weight


def stacked(A: Array, B: Array, c: Array, weight: Array, end: Array) -> tuple[Array, Array]:
    """M, F with the cost |M U + F [x0; 1]|^2 of all inputs U (T nu,)."""
    T, n, nu = B.shape
    M, F = np.zeros((n, T * nu)), np.eye(n, n + 1)
    rows, known, one = [], [], np.eye(n + 1)[-1:]
    for k in range(T):
        pick = np.zeros((nu, T * nu))
        pick[:, k * nu : (k + 1) * nu] = np.eye(nu)
        root = np.linalg.cholesky(weight[k]).T
        rows.append(root @ np.vstack([M, pick, np.zeros((1, T * nu))]))
        known.append(root @ np.vstack([F, np.zeros((nu, n + 1)), one]))
        M, F = A[k] @ M + B[k] @ pick, A[k] @ F + np.outer(c[k], one)
    root = np.linalg.cholesky(end).T
    return np.vstack([*rows, root @ M]), np.vstack([*known, root @ F])

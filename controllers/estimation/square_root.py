"""Filter covariances by their roots: P = S S' is never formed, so sensors of 1e-5 keep their digits beside large noise.

    x+ = A x + G w,   y = C x+ + H w + v;   w, v of covariance W, V

update  one sample: an orthogonal factorisation of what adds up (Potter; Morf and Kailath 1975)
stein   the limit of x+ = F x + J w: doubled, (S, F) -> (root of S S' + F S S'F', F F), by the same factorisation
white   what white noise over a period leaves (the integral of Van Loan 1978): Gauss's quadrature of a part, doubled
steady  the limit of many samples from a gain near it: Newton steps (Hewer 1971), each with P from `stein`, a sum of
        squares (Joseph) in which nothing cancels

Rows of the factored arrays are states or readings, each with its own unit; a factorisation from the right mixes
columns only, so that a reading in nanometres and one in kilometres keep the same digits.
"""

from __future__ import annotations

import numpy as np

from pliant.plants.core.errors import PliantError
from pliant.plants.core.imports import linalg
from pliant.plants.linear.even_units import even_units
from pliant.plants.linear.magnus import halvings

Array = np.ndarray
SETTLED = 1e-14  # of the standard deviations: change of a covariance
LARGEST_CHANGE = 1e-3  # of the standard deviations' products in the last step, above which none is given
NEWTON_STEPS = 30  # at most: from far off each halves the error, near by it squares it
POINTS = 10  # of the quadrature, over a part in which no rate passes one: of order 20
DOUBLINGS = 60  # at most: poles up to 1 - 1e-17


def triangle(M: Array) -> Array:
    """Lower triangular S (n, n) with S S' = M M', M (n, m), its diagonal >= 0."""
    n, m = M.shape
    wide = M if m >= n else np.hstack([M, np.zeros((n, n - m))])
    S = np.asarray(np.linalg.qr(wide.T, mode="r")).T
    return np.asarray(S * np.where(np.diagonal(S) < 0, -1.0, 1.0))


def update(state: Array, reading: Array) -> tuple[Array, Array, Array]:
    """L (nx, ny), root (nx, nx) after and root (ny, ny) of the innovation, where the state's error is state @ e and the
    innovation reading @ e: (nx, m) and (ny, m), with e of covariance one."""
    ny = len(reading)
    whole = triangle(np.vstack([reading, state]))
    own, crossed = whole[:ny, :ny], whole[ny:, :ny]
    return np.linalg.solve(own.T, crossed.T).T, whole[ny:, ny:], own


def white(A: Array, E: Array, density: Array, dt: float) -> tuple[Array, Array, Array]:
    """G (nx, nw), rest (nx, nx), W (nw, nw): over dt [s] white noise of density (nw, nw) [unit^2 s] moves dx/dt = A x +
    E w by G m + rest e, where m, of covariance W, is its mean over the period and e has covariance one.

    As the root of the integral for [m; x], so that directions that get little noise keep their digits.
    """
    nx, nw = E.shape
    n = nw + nx
    F, J = np.zeros((n, n)), np.zeros((n, nw))
    F[nw:, nw:] = A
    J[:nw], J[nw:] = np.eye(nw) / dt, E
    unit = even_units(F, (J**2 * np.diagonal(density)).sum(axis=1), np.zeros(n))
    F, J = F * (unit[None, :] / unit[:, None]), J / unit[:, None] @ np.linalg.cholesky(density)
    j = halvings(F * dt)
    h = dt / 2**j
    at, weight = np.polynomial.legendre.leggauss(POINTS)
    moved = linalg.expm(F * (h * (1 + at) / 2)[:, None, None]) @ (J * np.sqrt(h / 2 * weight)[:, None, None])
    S, step = triangle(np.hstack(list(moved))), linalg.expm(F * h)
    for _ in range(j):
        S, step = triangle(np.hstack([S, step @ S])), step @ step
    S = unit[:, None] * S
    own = S[:nw, :nw]
    return np.linalg.solve(own.T, S[nw:, :nw].T).T, S[nw:, nw:], own @ own.T


def stein(F: Array, J: Array) -> Array:
    """Root S (n, n) of P = F P F' + J J'; PliantError where F does not decay."""
    S = triangle(J)
    for _ in range(DOUBLINGS):
        more = F @ S
        length = np.linalg.norm(S, axis=1)
        if not np.isfinite(length).all():
            break
        S = triangle(np.hstack([S, more]))
        if (np.linalg.norm(more, axis=1) <= 1e-9 * length).all():  # its square is below rounding
            return S
        F = F @ F
    raise PliantError("the error of the filter does not decay: the covariance has no limit")


def steady(A: Array, C: Array, noise: Array, read: Array, root: Array) -> Array:
    """Root (nx, nx) of the covariance after a sample, in the limit, from a root near it.

    noise (nx, m), read (ny, m): what w and v of covariance one do to x+ and, through x+ too, to y.
    """
    seen, last, worst = C @ A, np.inf, np.inf
    for _ in range(NEWTON_STEPS):
        L, _, _ = update(np.hstack([A @ root, noise]), np.hstack([seen @ root, read]))
        found = stein(A - L @ seen, noise - L @ read)
        own = np.linalg.norm(found, axis=1)
        change = np.abs(found @ found.T - root @ root.T) / np.where(own > 0, own, np.inf) / own.clip(1e-300)[:, None]
        root, worst = found, float(change.max(initial=0.0))
        if worst <= SETTLED or worst >= last:
            break
        last = worst
    if not worst <= LARGEST_CHANGE:
        raise PliantError(
            f"the filter's covariance is known only to {worst:.2g} of itself, must be {LARGEST_CHANGE:g}: take sensors "
            "or process noise that are less far apart"
        )
    return root

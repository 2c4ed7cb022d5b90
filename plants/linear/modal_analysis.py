"""Modes of a linear model: their table, the states that dominate them, and truncation to a few of them.

Balanced truncation  states in which reachability and observability Gramians are equal and diagonal (Moore
1981,
    square-root algorithm of Laub et al. 1987); the error bound 2 (s_k+1 + .. + s_n) is Glover's and Enns's.
Modal truncation     ordered real Schur form, decoupled by a Sylvester equation, so that double rigid-body
modes are
    no obstacle; the error is the dropped part itself, bounded by twice the sum of its Hankel singular values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.core.parameters import require_choice, require_count


@dataclass(frozen=True)
class Mode:
    """One mode; a complex pair counts once, with its eigenvalue of positive imaginary part. A rigid-body mode, whose
    eigenvalue rounding hides, has 0.

    `damping_ratio` is -Re/|eigenvalue|, and 0 where rounding hides the real part (a rigid-body mode too).
    """

    number: int
    eigenvalue: complex  # [1/s], of the continuous-time model also where the model is sampled
    frequency_hz: float  # |eigenvalue| / 2 pi
    damped_frequency_hz: float  # Im(eigenvalue) / 2 pi
    damping_ratio: float
    dominant_state: str  # by participation factor

    def __str__(self) -> str:
        return self.name

    @property
    def name(self) -> str:
        """Like "mode 3: 18.9 Hz, zeta 0.01 (q21)"."""
        size = f"{self.frequency_hz:.3g} Hz, zeta {self.damping_ratio:.2g}"
        return f"mode {self.number}: {size} ({self.dominant_state})"


def dominant(left: np.ndarray, right: np.ndarray) -> int:
    """Index of the state that takes part most: largest |left_k right_k|, the first of those within 5 %.

    `left`, `right` (nx,): eigenvectors of one eigenvalue. Where they are orthogonal (a double root without a
    second eigenvector) the right one decides.
    """
    part = np.abs(left * right)
    if part.sum() < 1e-6 * np.linalg.norm(left) * np.linalg.norm(right):
        part = np.abs(right)
    return int(np.flatnonzero(part >= 0.95 * part.max())[0])


def eigen(A: np.ndarray, balance: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Eigenvalues (nx,), left and right eigenvectors (columns) of the balanced A, and rounding (nx,); of A as it is
    with `balance` False.

    An eigenvalue is known to 10 eps |A| / |left' right|, a double one to sqrt(10 eps) |A| (Wilkinson 1965).
    """
    scaled = linalg.matrix_balance(A, permute=False)[0] if balance else A
    lam, left, right = linalg.eig(scaled, left=True, right=True)
    size, eps = np.linalg.norm(scaled), 10 * np.finfo(float).eps
    cosine = np.abs(np.sum(left.conj() * right, axis=0))
    return lam.astype(complex), left.conj(), right, size * np.minimum(eps / np.maximum(cosine, eps), eps**0.5)


def refined(M: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Eigenvalues lambda (n,), eigenvectors V (columns), W = V^-1 and what |W M V - diag(lambda)| is at most (n, n).

    By two-sided Rayleigh quotients in extended precision, so that a root of 1 beside one of 1e15 keeps its digits.
    The last is infinite where V is no basis: M has fewer eigenvectors than states.
    """
    lam, V = np.linalg.eig(M)
    n, extended = len(M), np.longdouble if np.isrealobj(lam) else np.clongdouble
    unknown = lam.astype(complex), V.astype(complex), np.zeros((n, n)), np.full((n, n), np.inf)
    try:
        W = np.linalg.inv(V).astype(extended)
    except np.linalg.LinAlgError:
        return unknown
    V, A, one = V.astype(extended), M.astype(extended), np.eye(n)
    for last in (False, False, True):
        W = W @ (2 * one - V @ W)
        T = W @ (A @ V)
        if not np.isfinite(T.astype(complex)).all() or np.abs(W @ V - one).max() > 1e-6:
            return unknown
        lam = np.diagonal(T).copy()
        if last:
            break
        gap = lam[None, :] - lam[:, None]
        np.fill_diagonal(gap, 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            X = np.where(np.abs(T) < 0.1 * np.abs(gap), T / gap, 0)
        np.fill_diagonal(X, 0)
        V, W = V @ (one + X), (one - X) @ W
    off = np.abs(T).astype(float)
    np.fill_diagonal(off, 0.0)
    V, W = V.astype(complex), W.astype(complex)
    off += 2e-19 * n * (np.abs(W) @ np.abs(M) @ np.abs(V))  # rounding of the products
    return lam.astype(complex), V, W, off


def stays(lam: np.ndarray, rounding: np.ndarray, dt: float | None) -> np.ndarray:
    """Whether each mode (nx,) fails to decay, as far as rounding lets one tell."""
    return (lam.real if dt is None else np.abs(lam) - 1.0) >= -rounding


def rates(eigenvalues: np.ndarray, dt: float | None) -> np.ndarray:
    """Eigenvalues (n,) as [1/s]: log(z) / dt of the z plane's, -inf where z = 0; as they are where dt is None.

    What oscillates faster than half the sampling rate is seen at a lower frequency; pi / dt stands for z < 0.
    """
    if dt is None:
        return eigenvalues
    with np.errstate(divide="ignore"):
        return np.log(np.abs(eigenvalues)) / dt + 1j * (np.angle(eigenvalues) / dt)


def modes(A: np.ndarray, states: Sequence[str], dt: float | None = None) -> tuple[Mode, ...]:
    """Modes of A (nx, nx), slowest first. With `dt` [s], A maps one sample to the next."""
    if not len(A):
        return ()
    values, left, right, rounding = eigen(A)
    lam = rates(values, dt)
    undamped = np.abs(values.real if dt is None else np.abs(values) - 1.0) <= rounding
    # A double root at rest leaves rounding as two real roots or as a pair, by chance: two rigid-body modes either way.
    still = np.abs(values - (0.0 if dt is None else 1.0)) <= rounding
    lam = np.where(still, 0.0, lam)
    rows: list[Mode] = []
    for i in np.argsort(np.abs(lam), kind="stable"):
        if values[i].imag < 0 and not still[i]:
            continue
        size = abs(lam[i])
        zeta = 0.0 if undamped[i] else 1.0 if np.isinf(size) else -lam[i].real / size
        state = states[dominant(left[:, i], right[:, i])]
        f, fd = size / (2 * np.pi), abs(lam[i].imag) / (2 * np.pi)
        rows.append(Mode(len(rows) + 1, complex(lam[i]), float(f), float(fd), float(zeta), state))
    return tuple(rows)


def _gramian_root(A: np.ndarray, B: np.ndarray, discrete: bool) -> np.ndarray:
    """S (nx, nx) with S S^T the reachability Gramian of (A, B)."""
    W = linalg.solve_discrete_lyapunov(A, B @ B.T) if discrete else linalg.solve_continuous_lyapunov(A, -B @ B.T)
    return semidefinite_root(W)


def hankel_values(A: np.ndarray, B: np.ndarray, C: np.ndarray, dt: float | None = None) -> np.ndarray:
    """Hankel singular values (nx,), largest first, of a stable model."""
    if not len(A):
        return np.zeros(0)
    S, R = _gramian_root(A, B, dt is not None), _gramian_root(A.T, C.T, dt is not None)
    return np.linalg.svd(R.T @ S, compute_uv=False)


def truncation(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, order: int, method: str = "balanced", dt: float | None = None
) -> tuple[np.ndarray, np.ndarray, float]:
    """L (order, nx), R (nx, order) and an error bound: the reduced model is L A R, L B, C R, its state L x.

    The bound holds for the largest gain over all frequencies (H-infinity) from all columns of B to all rows
    of C. "balanced" needs a model whose modes all decay. "modal" keeps the modes that grow, then the slowest;
    the bound is infinite where it drops an undamped one.
    """
    require_choice("LinearModel.reduce", "method", method, ("balanced", "modal"))
    order = require_count("LinearModel.reduce", "order", order, 1, len(A))
    return (_balanced if method == "balanced" else _modal)(A, B, C, int(order), dt)


def _balanced(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, order: int, dt: float | None
) -> tuple[np.ndarray, np.ndarray, float]:
    lam, _, _, rounding = eigen(A)
    still = stays(lam, rounding, dt)
    if still.any():
        worst = lam[still][0]
        raise ValueError(
            f"LinearModel.reduce: method = 'balanced' needs modes that all decay; "
            f"eigenvalue {worst:.4g} does not: take method='modal'"
        )
    S, Rt = _gramian_root(A, B, dt is not None), _gramian_root(A.T, C.T, dt is not None)
    U, sigma, Vt = np.linalg.svd(Rt.T @ S)
    rank = int(np.sum(sigma > 1e-12 * sigma[0])) if sigma[0] > 0 else 0
    if order > rank:
        raise ValueError(f"LinearModel.reduce: order = {order} must be at most {rank}, the states reached and seen")
    scale = np.sqrt(sigma[:order])
    return (U[:, :order] / scale).T @ Rt.T, S @ Vt[:order].T / scale, float(2 * sigma[order:].sum())


def _modal(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, order: int, dt: float | None
) -> tuple[np.ndarray, np.ndarray, float]:
    lam, _, _, rounding = eigen(A)
    with np.errstate(divide="ignore"):
        rate = lam if dt is None else np.log(lam)
    undamped = stays(lam, rounding, dt)
    grows = undamped & ~stays(-lam if dt is None else 1 / np.where(undamped, lam, 1.0), rounding, dt)
    still = np.abs(lam - (0 if dt is None else 1)) <= rounding
    rank = np.where(grows, -1.0, np.where(still, 0.0, np.abs(rate)))
    near = 1e-9 * max(rank[np.isfinite(rank)].max(initial=0.0), 1e-300)
    allowed = sorted({int(np.sum(rank <= r + near)) for r in rank})
    if order not in allowed:
        raise ValueError(
            f"LinearModel.reduce: order = {order} must be one of {', '.join(map(str, allowed))}: "
            "growing modes are kept, and no pair is split"
        )
    if order == len(A):
        return np.eye(len(A)), np.eye(len(A)), 0.0
    kept = rank <= np.sort(rank)[order - 1] + near

    def wanted(re: float, im: float = 0.0) -> bool:
        distance = np.abs(lam - (complex(re) + 1j * im))
        return bool(distance[kept].min() <= distance[~kept].min())

    T, Z, count = linalg.schur(A, output="real", sort=wanted)
    if count != order:
        raise ValueError(f"LinearModel.reduce: order = {order} splits a cluster of equal modes; {count} does not")
    X = linalg.solve_sylvester(T[:order, :order], -T[order:, order:], -T[:order, order:])
    L, R = Z[:, :order].T - X @ Z[:, order:].T, Z[:, :order]
    if undamped[~kept].any():
        return L, R, np.inf
    rest = Z[:, :order] @ X + Z[:, order:]
    return L, R, float(2 * hankel_values(T[order:, order:], Z[:, order:].T @ B, C @ rest, dt).sum())

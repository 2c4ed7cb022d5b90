"""The upper bound of the structured singular value by D and G scalings.

    mu(M) <= beta  where  beta^2 D - M* D M - j (G M - M* G) > 0  for some D > 0, G of the structure

(Fan, Tits and Doyle 1991, in the form of Young, Newlin and Doyle). For beta fixed that is a linear matrix inequality;
the least beta is a generalised eigenvalue problem, solved by the method of centres (Boyd and El Ghaoui 1993): Newton's
method finds the scalings that are furthest inside, by the determinants, then beta falls to just above what they allow.
Any scalings bound; what is returned is computed from those found by one eigenvalue problem of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as sla

from .blocks import Structure

Array = np.ndarray
SHARE = 0.15  # of the way back from the least beta^2 that scalings allow to the one before
CENTRES, NEWTON = 60, 12
CENTRED = 0.3  # Newton decrement
TOLERANCE = 1e-3  # relative, of beta: where centres stop falling
ZERO = 1e-4  # times |M|: a bound below which none is looked for
RIDGE = 1e-10
OSBORNE = 10  # rounds


@dataclass(frozen=True, eq=False)
class Scalings:
    """D, G (n, n) and the bound that they give."""

    beta: float
    D: Array
    G: Array


def allowed(M: Array, D: Array, G: Array) -> float:
    """The least beta^2 that D and G show, at least 0; infinite where D is not positive."""
    try:
        L = np.linalg.cholesky(D)
    except np.linalg.LinAlgError:
        return float("inf")
    N = _pushed(M, D, G)
    half = sla.solve_triangular(L, N, lower=True)
    whole = sla.solve_triangular(L, half.conj().T, lower=True)
    return max(0.0, float(np.linalg.eigvalsh((whole + whole.conj().T) / 2)[-1]))


def upper(M: Array, of: Structure, start: Scalings | None = None, enough: float = 0.0) -> Scalings:
    """The least bound of M (n, n) by scalings of a structure; stops at once where it is below `enough`.

    start: scalings found elsewhere, tried first.
    """
    n, size = len(M), float(np.linalg.norm(M, 2)) if M.size else 0.0
    if size == 0:
        return Scalings(0.0, np.eye(n), np.zeros((n, n)))
    unit = _balanced(M, of) if start is None else np.sqrt(np.diag(start.D).real)
    for group in of.groups:
        unit[group] = unit[group.start]
    M = M * unit[:, None] / unit
    size = float(np.linalg.norm(M, 2))
    M = M / size
    moved = np.concatenate([M.conj().T @ of.D @ M, 1j * (of.G @ M - M.conj().T @ of.G)])
    x = _coordinates(of, start, unit, size)
    D, G = _combined(of, x)
    best, at = allowed(M, D, G), x
    if best > 1.0 + 1e-9:  # the diagonal alone does better
        x = _coordinates(of, None, unit, size)
        D, G = _combined(of, x)
        best, at = allowed(M, D, G), x
    t, wanted = best * 1.1 + ZERO**2, (enough / size) ** 2
    for _ in range(CENTRES):
        if best <= max(wanted, ZERO**2):
            break
        x = _centre(np.concatenate([t * of.D, np.zeros_like(of.G)]) - moved, of.D, x)
        D, G = _combined(of, x)
        found, before = allowed(M, D, G), best
        if found < best:
            best, at = found, x
        if not found < t or (t - found < TOLERANCE * t and before - best < TOLERANCE * before):
            break
        t = found + SHARE * (t - found)
    D, G = _combined(of, at)
    both = unit[:, None] * unit
    return Scalings(float(np.sqrt(max(best, 0.0)) * size), D * both, G * both * size)


def _balanced(M: Array, of: Structure) -> Array:
    """d (n,): rows and columns of diag(d) M diag(1/d) of like size, group by group (Osborne 1960)."""
    d, size = np.ones(len(M)), np.abs(M)
    np.fill_diagonal(size, 0.0)
    for _ in range(OSBORNE):
        for group in of.groups:
            row = np.linalg.norm(size[group])
            column = np.linalg.norm(size[:, group])
            if row > 0 and column > 0:
                factor = np.sqrt(column / row)
                size[group] *= factor
                size[:, group] /= factor
                d[group] *= factor
    return d


def _pushed(M: Array, D: Array, G: Array) -> Array:
    N = M.conj().T @ D @ M + 1j * (G @ M - M.conj().T @ G)
    return (N + N.conj().T) / 2


def _combined(of: Structure, x: Array) -> tuple[Array, Array]:
    k, n = len(of.D), of.D.shape[-1]
    G = np.tensordot(x[k:], of.G, 1) if len(of.G) else np.zeros((n, n), dtype=complex)
    return np.tensordot(x[:k], of.D, 1), G


def _coordinates(of: Structure, start: Scalings | None, unit: Array, size: float) -> Array:
    """Of the identity, or of scalings found elsewhere."""
    n, both = of.D.shape[-1], unit[:, None] * unit
    D = np.eye(n) if start is None else start.D / both
    G = np.zeros((n, n)) if start is None else start.G / both / size

    def onto(basis: Array, given: Array) -> Array:
        return np.array([np.vdot(e, given).real / np.vdot(e, e).real for e in basis])

    return n / np.trace(D).real * np.concatenate([onto(of.D, D), onto(of.G, G)])


def _centre(F: Array, Ds: Array, x: Array) -> Array:
    """Newton's method on -log det F(x) - log det D(x), the trace of D held."""
    k, K, n = len(Ds), len(F), F.shape[-1]
    trace = np.concatenate([np.trace(Ds, axis1=1, axis2=2).real, np.zeros(K - k)])

    def value(y: Array) -> float:
        try:
            a = np.linalg.cholesky(np.tensordot(y, F, 1))
            b = np.linalg.cholesky(np.tensordot(y[:k], Ds, 1))
        except np.linalg.LinAlgError:
            return float("inf")
        return -2 * float(np.log(np.diag(a).real).sum() + np.log(np.diag(b).real).sum())

    now = value(x)
    for _ in range(NEWTON):
        if not np.isfinite(now):
            return x
        gradient, hessian = np.zeros(K), np.zeros((K, K))
        for matrices, count in ((F, K), (Ds, k)):
            L = np.linalg.cholesky(np.tensordot(x[:count], matrices, 1))
            W = sla.solve_triangular(L, np.eye(n), lower=True)
            T = (W @ matrices @ W.conj().T).reshape(count, -1)
            gradient[:count] -= T[:, :: n + 1].sum(axis=1).real
            hessian[:count, :count] += T.real @ T.real.T + T.imag @ T.imag.T
        hessian += RIDGE * np.trace(hessian) / K * np.eye(K)
        both = np.column_stack([-gradient, trace])
        solved = sla.solve(hessian, both, assume_a="pos")
        step = solved[:, 0] - solved[:, 1] * (trace @ solved[:, 0]) / (trace @ solved[:, 1])
        decrement = float(np.sqrt(max(-gradient @ step, 0.0)))
        length = 1.0 if decrement < CENTRED else 1 / (1 + decrement)
        while (then := value(x + length * step)) > now and length > 1e-6:
            length /= 2
        if not then <= now:
            return x
        x, now = x + length * step, then
        if decrement < CENTRED:
            break
    return x

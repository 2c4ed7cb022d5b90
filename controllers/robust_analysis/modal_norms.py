"""Norms x' P x, one for each of a few like matrices, in which each falls as slowly as its own modes do.

A sampled loop's matrices A_c are taken apart into modes, and modes matched with those of the first. Of a mode apart
from all others P is |w x|^2 of its left eigenvector w, of the length that takes the first one's eigenvector to one; of
modes that are nearly one, whose eigenvectors say nothing, the sum of |x|^2 on the way from there, g^-j A^j Pi x, Pi the
projector onto all of them. A mode that only turns faster keeps its norm. Weights of the modes even out what the
matrices change between them.

Source   Osborne 1960, "On pre-conditioning of matrices", for the weights
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pliant.plants.core.imports import linalg

Array = np.ndarray
DOUBLINGS = 40
CLOSE, LARGE = 1e-13, 1e100  # of powers: a sum that has ended, and one that does not
LYAPUNOV, TOWARDS = 0.5, 0.3  # g^2, of the way from the largest |eigenvalue|^2 to 1: of all modes, and of some
WORST_BASIS = 1e8  # condition number
SMALL = 1e-9  # of the largest change between groups: what two that nothing couples are weighed by


class Norms(NamedTuple):
    """T (n, n) and its inverse, P = T' T of the first matrix; own (m, n, n): P_c of the others in coordinates T x."""

    T: Array
    inverse: Array
    own: Array


def lyapunov_norms(A: Array, share: float) -> Norms | None:
    """P_c = sum_j (A_c/g)'^j (A_c/g)^j of A (m, n, n), all |eigenvalues| below one."""
    g2 = _between(A, share)
    P = _sums(A / np.sqrt(g2), np.tile(np.eye(A.shape[-1]), (len(A), 1, 1)))
    if P is None:
        return None
    T = np.linalg.cholesky((P[0] + P[0].T) / 2).T
    return _norms(T, P)


def modal_norms(A: Array, alike: float) -> Norms | None:
    """Of A (m, n, n), all |eigenvalues| below one; modes whose eigenvectors' cosine is above `alike` are one group."""
    start = lyapunov_norms(A[:1], LYAPUNOV)
    if start is None:
        return None
    A = start.T @ A @ start.inverse
    values, V = np.linalg.eig(A)
    groups = _groups(values[0], V[0], alike)
    first, parts = np.linalg.inv(V[0]), np.zeros((len(groups), *A.shape))
    for c in range(len(A)):
        if not np.linalg.cond(V[c]) < 1 / np.finfo(float).eps:
            return None
        order = _matched(np.abs(first @ V[c]))
        right = V[c][:, order]
        left = np.linalg.inv(right)
        for k, group in enumerate(groups):
            if len(group) == 1 or (len(group) == 2 and values[0][group[0]].imag != 0):
                w = left[group] / (left[group] @ V[0][:, group]).diagonal()[:, None]
                parts[k, c] = (w.conj().T @ w).real
                continue
            onto = (right[:, group] @ left[group]).real
            r2 = float(np.abs(values[c][order][group]).max()) ** 2
            found = _sums((onto @ A[c] / np.sqrt(r2 + TOWARDS * (1 - r2)))[None], (onto.T @ onto)[None])
            if found is None:
                return None
            parts[k, c] = found[0]
    return _weighted(A, parts, groups, start)


def _matched(alike: Array) -> Array:
    """Of each row of `alike` (n, n) a column of its own, of the largest sum in all."""
    best = alike.argmax(axis=1)
    if len(set(best.tolist())) == len(best) and ((alike >= alike.max(axis=1)[:, None]).sum(axis=1) == 1).all():
        return np.asarray(best)  # no sum is larger than that of the largest of all rows
    from scipy.optimize import linear_sum_assignment

    return np.asarray(linear_sum_assignment(-alike)[1])


def _groups(values: Array, V: Array, alike: float) -> list[list[int]]:
    X = V / np.linalg.norm(V, axis=0)
    near = np.abs(X.conj().T @ X) > alike
    near |= np.abs(values[:, None] - values.conj()) <= 1e-9 * np.abs(values)  # a pair
    left, groups = set(range(len(values))), []
    while left:
        group = {min(left)}
        while new := {int(j) for i in group for j in np.flatnonzero(near[i])} - group:
            group |= new
        left -= group
        groups.append(sorted(group))
    return groups


def _weighted(A: Array, parts: Array, groups: list[list[int]], start: Norms) -> Norms | None:
    """The sum of the groups' norms with weights."""
    rows = []
    for part, group in zip(parts, groups):
        sizes, vectors = np.linalg.eigh(part[0])
        rows.append((np.sqrt(np.maximum(sizes[-len(group) :], 0)) * vectors[:, -len(group) :]).T)
    R, ends = np.vstack(rows), np.cumsum([0, *(len(g) for g in groups)])
    if not np.linalg.cond(R) < WORST_BASIS:
        return None
    moved = np.abs(R @ (A[1:] - A[0]) @ np.linalg.inv(R)).max(axis=0) ** 2
    between = np.sqrt(np.add.reduceat(np.add.reduceat(moved, ends[:-1], axis=0), ends[:-1], axis=1))
    between += SMALL * between.max() + np.finfo(float).tiny
    weights = 1 / linalg.matrix_balance(between, permute=False, separate=True)[1][0]
    T = R * np.repeat(weights, np.diff(ends))[:, None]
    P = np.einsum("g,gcij->cij", weights**2, parts)
    return _norms(T @ start.T, start.T.T @ P @ start.T)


def _norms(T: Array, P: Array) -> Norms:
    inverse = np.linalg.inv(T)
    own = inverse.T @ P[1:] @ inverse
    return Norms(T, inverse, (own + np.swapaxes(own, 1, 2)) / 2)


def _between(A: Array, share: float) -> float:
    largest = float(np.abs(np.linalg.eigvals(A)).max()) ** 2
    return largest + share * (1 - largest)


def _sums(A: Array, P: Array) -> Array | None:
    """sum_j A'^j P A^j of each (m, n, n), by doubling; None where one does not end."""
    for _ in range(DOUBLINGS):
        P = P + np.swapaxes(A, 1, 2) @ P @ A
        A = A @ A
        size = np.abs(A).max()
        if size < CLOSE:
            return P
        if not size < LARGE:
            return None
    return None

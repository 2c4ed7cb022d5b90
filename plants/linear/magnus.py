"""Transition matrices of dz/dt = A(t) z over many short steps at once.

exponent  order four on two Gauss points (Iserles and Norsett 1999)
steps     Magnus expansion of order six on three Gauss points (Blanes, Casas, Oteo and Ros 2009, Eqs (252)-(257));
          where A(t) lies in a Lie algebra, such as that of Hamiltonian matrices, the step lies in its group to rounding
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from .even_units import even_units, stacked_expm
from .even_units import expm as expm

GAUSS3 = 0.5 + np.sqrt(0.15) * np.array([-1.0, 0.0, 1.0])  # three-point Gauss-Legendre nodes on [0, 1]

MOST_TERMS = 40  # of a series


def steps(A: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Phi (m, n, n) over steps h (m,) [s] from A (m, 3, n, n) at the three Gauss points of each."""
    h = h[:, None, None]
    a1 = h * A[:, 1]
    a2 = np.sqrt(15.0) / 3.0 * h * (A[:, 2] - A[:, 0])
    a3 = 10.0 / 3.0 * h * (A[:, 2] - 2.0 * A[:, 1] + A[:, 0])
    c1 = _bracket(a1, a2)
    c2 = _bracket(a1, 2.0 * a3 + c1) / -60.0
    return expm(a1 + a3 / 12.0 + _bracket(c1 - 20.0 * a1 - a3, a2 + c2) / 240.0)


def _bracket(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    return X @ Y - Y @ X


def product(Phi: np.ndarray) -> np.ndarray:
    """Phi[m-1] .. Phi[1] Phi[0] of a stack (m, n, n), or (.., m, n, n), by halves."""
    while Phi.shape[-3] > 1:
        m = Phi.shape[-3]
        last = Phi[..., m - 1 :, :, :] if m % 2 else None
        Phi = Phi[..., 1::2, :, :] @ Phi[..., : m - m % 2 : 2, :, :]
        if last is not None:
            Phi = np.concatenate([Phi, last], axis=-3)
    return Phi[..., 0, :, :]


def largest_growths(Phi: np.ndarray) -> np.ndarray:
    """The largest singular values (..) of Phi (.., n, n), to rounding: the roots of the largest eigenvalue of Phi'Phi,
    which costs a third of a decomposition. Not a number where an entry is none or infinite.
    """
    size = np.abs(Phi).max(axis=(-2, -1), initial=0.0)
    known = np.isfinite(size)
    unit = np.where(known & (size > 0), size, 1.0)
    even = np.where(known[..., None, None], Phi, 0.0) / unit[..., None, None]
    square = np.linalg.eigvalsh(np.swapaxes(even, -1, -2) @ even)[..., -1]
    return np.where(known, np.sqrt(np.maximum(square, 0.0)) * unit, np.nan)


def grouped(Phi: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Products of Phi (m, n, n) between the indices edges (k+1,), ascending from 0 to m: (k, n, n)."""
    width = np.diff(edges)
    if len(width) and (width == width[0]).all():
        return product(Phi.reshape(len(width), width[0], *Phi.shape[1:]))
    return np.array([product(Phi[a:b]) for a, b in pairwise(edges)])


def exponent(N: np.ndarray, h: np.ndarray) -> np.ndarray:
    """The Magnus exponent of order four of steps h (m,) [s] from N (m, 2, n, n + k) at two Gauss points of each.

    h/2 (N1 + N2) - sqrt(3)/12 h^2 [N1, N2] (Iserles and Norsett 1999); with k > 0 the rows of N below are zero.
    """
    n, h = N.shape[-2], h[:, None, None]
    commutator = N[:, 0, :, :n] @ N[:, 1] - N[:, 1, :, :n] @ N[:, 0]
    return h / 2 * (N[:, 0] + N[:, 1]) - np.sqrt(3.0) / 12 * h**2 * commutator


def halvings(Omega: np.ndarray) -> int:
    """j with |Omega / 2^j| <= 1 (largest row sum) for every matrix of a stack (.., n, n)."""
    size = float(np.abs(Omega).sum(axis=-1).max(initial=0.0))
    return max(0, math.ceil(math.log2(max(size, 1e-300))))


def with_cost(F: np.ndarray, M: np.ndarray, N: np.ndarray, j: int) -> tuple[np.ndarray, np.ndarray]:
    """e^F and the integral of e^(F's) M e^(Fs) over a unit step, from the exponent [[N, M], [0, F]] (.., 2n, 2n).

    N is -F' but for the higher terms of an exponent. Found on 2^-j of the step by one exponential (Van Loan 1978), then
    doubled j times, so that no growing exponential appears however stiff F is.
    """
    n = F.shape[-1]
    big = np.zeros((*F.shape[:-2], 2 * n, 2 * n))
    big[..., :n, :n], big[..., :n, n:], big[..., n:, n:] = N, M, F
    parts = stacked_expm(big / 2**j)
    step = parts[..., n:, n:]
    cost = np.swapaxes(step, -1, -2) @ parts[..., :n, n:]
    for _ in range(j):
        cost, step = cost + np.swapaxes(step, -1, -2) @ cost @ step, step @ step
    return step, cost


def costed(F: np.ndarray, M: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The transitions of dz/dt = F z over steps h (m,) and the integrals of z'M z as forms of z at the start of each.

    F (m, 2, n, n) at two Gauss points, M (n, n) or (m, 2, n, n), symmetric: (m, n, n) each, and the even units (n,) in
    which they were found, so that they do not depend on those that z is in.
    """
    n = F.shape[-1]
    sight = np.abs(np.diagonal(M, axis1=-2, axis2=-1)).reshape(-1, n).max(axis=0)
    unit = even_units(F, np.zeros(n), sight)
    ratio, weight = unit[None, :] / unit[:, None], unit[:, None] * unit
    big = np.zeros((*F.shape[:2], 2 * n, 2 * n))
    big[:, :, n:, n:], big[:, :, :n, n:] = F * ratio, M * weight
    big[:, :, :n, :n] = -big[:, :, n:, n:].swapaxes(-1, -2)
    Omega = exponent(big, h)
    step, cost = with_cost(Omega[:, n:, n:], Omega[:, :n, n:], Omega[:, :n, :n], halvings(Omega[:, n:, n:]))
    return step / ratio, (cost + cost.swapaxes(-1, -2)) / 2 / weight, unit


def reached(A: np.ndarray, drive: np.ndarray, h: np.ndarray) -> np.ndarray:
    """The integrals (m, n, n) of Phi(end, s) drive Phi(end, s)' over steps h (m,) of dz/dt = A z (Van Loan 1978): the
    Gramian of what a drive E E' reaches, the covariance that white noise leaves. A, drive (m, 2, n, n) at Gauss points.
    """
    n = A.shape[-1]
    reach = np.abs(np.diagonal(drive, axis1=2, axis2=3)).max(axis=(0, 1), initial=0.0)
    unit = even_units(A, reach, np.zeros(n))
    ratio, weight = unit[None, :] / unit[:, None], unit[:, None] * unit
    big = np.zeros((*A.shape[:2], 2 * n, 2 * n))
    big[:, :, :n, :n], big[:, :, :n, n:] = A * ratio, drive / weight
    big[:, :, n:, n:] = -big[:, :, :n, :n].swapaxes(-1, -2)
    Omega = exponent(big, h)
    own = Omega[:, :n, :n]
    _, found = with_cost(own.swapaxes(-1, -2), Omega[:, :n, n:], -own, halvings(own))
    return (found + found.swapaxes(-1, -2)) / 2 * weight


def reached_by(A: np.ndarray, E: np.ndarray, h: np.ndarray) -> np.ndarray:
    """`reached` of a drive E E' of few columns, E (m, 2, n, k) at Gauss points, for much less work.

    The exponent of the drive is U S U' of few columns too, U = [E1, E2, A1 E2, A2 E1]. With F that of A, the integral
    of e^(F s) U S U' e^(F's) over [0, 1] is the sum over i, j of F^i U S (F^j U)' / (i! j! (i + j + 1)).
    Where |F| is large it is `reached`.
    """
    n, k = E.shape[-2:]
    reach = np.square(E).sum(axis=-1).max(axis=(0, 1), initial=0.0)
    unit = even_units(A, reach, np.zeros(n))
    A, E = A * (unit / unit[:, None]), E / unit[:, None]
    F = exponent(A, h)
    size = float(np.abs(F).sum(axis=-1).max(initial=0.0))
    terms = next((t for t in range(2, MOST_TERMS) if (2 * size) ** t / math.factorial(t) < 1e-17), 0)
    if not terms or 8 * k * terms > 12 * n:
        return reached(A, E @ np.swapaxes(E, -1, -2), h) * (unit[:, None] * unit)
    (A1, A2), (E1, E2) = (np.moveaxis(M, 1, 0) for M in (A, E))
    U = np.concatenate([E1, E2, A1 @ E2, A2 @ E1], axis=-1)
    one, S = np.eye(k), np.zeros((len(h), 4 * k, 4 * k))
    early, late, first, second = (slice(i * k, (i + 1) * k) for i in range(4))
    S[:, early, early] = S[:, late, late] = (h / 2)[:, None, None] * one
    skew = (np.sqrt(3.0) / 12 * h**2)[:, None, None] * one  # of [[A1, D1], [0, -A1']], [[A2, D2], [0, -A2']]
    S[:, first, late] = S[:, late, first] = -skew
    S[:, second, early] = S[:, early, second] = skew
    pushes = np.empty((len(h), terms, n, 4 * k))
    pushes[:, 0] = U
    for i in range(1, terms):
        np.matmul(F, pushes[:, i - 1] / i, out=pushes[:, i])
    weights = 1 / (1 + np.add.outer(np.arange(terms), np.arange(terms)))
    later = np.tensordot(pushes, weights, axes=(1, 0)).transpose(0, 3, 1, 2) @ S[:, None]
    left, right = (M.transpose(0, 2, 1, 3).reshape(len(h), n, -1) for M in (later, pushes))
    found = left @ right.swapaxes(-1, -2)
    return np.asarray((found + found.swapaxes(-1, -2)) / 2 * (unit[:, None] * unit))


def consecutive(blocks: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """(length, products, logs) for each length from one: the products of so many consecutive blocks (m, n, n), from
    each that has as many behind it, divided by e^logs, so that none overflows.
    """
    now, logs = blocks, np.zeros(len(blocks))
    for length in range(1, len(blocks) + 1):
        if length > 1:
            now, logs = blocks[length - 1 :] @ now[:-1], logs[:-1]
        size = np.abs(now).max(axis=(1, 2))
        size = np.where(size > 0, size, 1.0)
        now, logs = now / size[:, None, None], logs + np.log(size)
        yield length, now, logs

"""Units in which a linear model has entries of one size, found from the model alone: whatever units it is given in, its
scaled entries are the same to a factor of two, and so is all that is computed from them.

    z = x / unit,   dz/dt = (unit^-1 A unit) z

Two steps. Least squares in logarithms bring every entry that is not zero to one size (Curtis and Reid 1972): exactly
the same entries from any units. From there, Newton's method minimises the Frobenius norm of the Hamiltonian matrix
[[A, -G], [-Q, -A']] over diagonal symplectic scalings (Benner 2001), which entries that are rounding do not sway.
Where a state is neither reached nor seen, nothing says its unit: a small G and Q of its own keep it near the first.
"""

from __future__ import annotations

import math

import numpy as np

from pliant.plants.core.imports import linalg

Array = np.ndarray
FLOOR = 1e-16  # square of the G and Q that every state has besides, against the rest of its row and column
FIRST = 5  # steps in logarithms before Newton's: from far off each of his moves an exponent by one alone
SHARE = 0.15  # of what balances a row and its column; a quarter does where no other moves (Osborne 1960)
NEWTON_STEPS = 200  # at most
TAYLOR = [1.0 / math.factorial(k) for k in range(13)]
REACH = 0.34  # one-norm up to which the Taylor polynomial is exact to rounding
TOGETHER = 30_000  # numbers of a stack at once: what a core has at hand
FEW, MOST_SQUARINGS = 8, 10  # of a stack; each squaring doubles what rounding left
LONGEST = 1.0  # step of a logarithm


def even_units(A: Array, reach: Array, sight: Array) -> Array:
    """Units (n,), powers of two, of the states of A (n, n) or (.., n, n).

    reach, sight (n,): what drives the states and what sees them, diagonals of G = B R^-1 B' and Q; zeros where none.
    Scaled, G is G / (unit unit') and Q is Q (unit unit').

    Example
    -------
    >>> even_units(np.array([[0.0, 1.0], [-1e6, 0.0]]), np.zeros(2), np.zeros(2)).tolist()  # rad, rad/s at 1000 rad/s
    [0.03125, 32.0]
    """
    n = A.shape[-1]
    size = np.abs(A.reshape(-1, n, n)).max(axis=0, initial=0.0)
    np.fill_diagonal(size, 0.0)
    first = _curtis_reid(size, np.abs(reach), np.abs(sight))
    between = _scaled(size, first[None, :] - first[:, None]) ** 2
    ends = [_scaled(np.abs(v), s * 2 * first) ** 2 for v, s in ((reach, -1), (sight, 1))]
    return np.asarray(np.exp2(np.round((first + _symplectic(between, *ends)) / np.log(2))))


def even_expm(M: Array) -> Array:
    """e^M of M (.., n, n), computed in even units: small entries beside large ones keep their digits too."""
    none = np.zeros(M.shape[-1])
    unit = even_units(M, none, none)
    ratio = unit[None, :] / unit[:, None]
    return stacked_expm(M * ratio) / ratio


def stacked_expm(M: Array) -> Array:
    """e^M of M (.., n, n): many at once, those that need as many squarings together, so that none is squared more often
    than it must be; SciPy's of few, and of those that need many.
    """
    flat, n = M.reshape(-1, *M.shape[-2:]), M.shape[-1]
    if len(flat) < FEW or not n:
        return np.asarray(linalg.expm(M))
    size = np.abs(flat).sum(axis=-2).max(axis=-1)
    need = np.ceil(np.log2(np.maximum(size / REACH, 1.0))).astype(int)
    found = np.empty_like(flat)
    for k in np.unique(need):
        own = need == k
        found[own] = expm(flat[own]) if k <= MOST_SQUARINGS else linalg.expm(flat[own])
    return found.reshape(M.shape)


def expm(A: Array) -> Array:
    """e^A of a stack A (m, n, n); all are scaled by the power of two that the largest needs.

    Taylor's polynomial of degree 12 in five products (Paterson and Stockmeyer 1973), scaled and squared.
    """
    size = float(np.abs(A).sum(axis=-2).max(initial=0.0))
    squarings = max(0, math.ceil(math.log2(size / REACH))) if size > 0 else 0
    found, some = np.empty(A.shape, np.result_type(A, 1.0)), max(1, TOGETHER // max(A.shape[-1] ** 2, 1))
    for begin in range(0, len(A), some):
        found[begin : begin + some] = _expm(A[begin : begin + some], squarings)
    return found


def _expm(A: Array, squarings: int) -> Array:
    A = A * 0.5**squarings
    A2 = A @ A
    A3 = A2 @ A
    one = np.eye(A.shape[-1])
    P = TAYLOR[9] * one + TAYLOR[10] * A + TAYLOR[11] * A2 + TAYLOR[12] * A3
    for k in (6, 3, 0):
        P = P @ A3
        P += TAYLOR[k] * one
        P += TAYLOR[k + 1] * A
        P += TAYLOR[k + 2] * A2
    for _ in range(squarings):
        P = P @ P
    return P


def input_units(R: Array) -> Array:
    """Units (nu,), powers of two, in which the diagonal of R (nu, nu) > 0 is within [1/2, 2]."""
    return np.exp2(-np.round(np.log2(np.diagonal(R)) / 2))


def _scaled(size: Array, log: Array) -> Array:
    """size exp(log), zero where size is: without overflow."""
    safe = np.where(size > 0, size, 1.0)
    return np.where(size > 0, np.exp(np.log(safe) + log), 0.0)


def _curtis_reid(size: Array, reach: Array, sight: Array) -> Array:
    """Logarithms d (n,) of units: log size_ij + d_j - d_i, log reach_i - 2 d_i and log sight_i + 2 d_i near one level,
    which is free. Of the solutions the one nearest zero: the others have the same scaled entries."""
    n = len(size)
    there, own = (size > 0) * 1.0, ((reach > 0) * 1.0, (sight > 0) * 1.0)
    log = np.log(np.where(size > 0, size, 1.0))
    logs = [np.log(np.where(v > 0, v, 1.0)) for v in (reach, sight)]
    rows, columns, both = there.sum(axis=1), there.sum(axis=0), own[0] + own[1]
    normal, right = np.zeros((n + 1, n + 1)), np.zeros(n + 1)  # the last unknown is the level
    normal[:n, :n] = np.diag(rows + columns + 4.0 * both) - (there + there.T)
    normal[:n, n] = normal[n, :n] = rows - columns + 2.0 * (own[0] - own[1])
    normal[n, n] = rows.sum() + both.sum()
    right[:n] = log.sum(axis=1) - log.sum(axis=0) + 2.0 * (logs[0] - logs[1])
    right[n] = log.sum() + logs[0].sum() + logs[1].sum()
    return np.asarray(np.linalg.lstsq(normal, right, rcond=1e-13)[0][:n])


def _symplectic(a: Array, g: Array, q: Array) -> Array:
    """d (n,) of least 2 sum a_ij e^(2 d_j - 2 d_i) + sum g_i e^(-4 d_i) + sum q_i e^(4 d_i); a, g, q are squares."""
    n = len(a)
    whole = a.sum(axis=0) + a.sum(axis=1) + g + q
    floor = FLOOR * np.where(whole > 0, whole, 1.0)
    g, q, d = g + floor, q + floor, np.zeros(n)
    for k in range(FIRST + NEWTON_STEPS):
        E = a * np.exp(2 * (d[None, :] - d[:, None]))
        reach, sight = g * np.exp(-4 * d), q * np.exp(4 * d)
        rows, columns = E.sum(axis=1), E.sum(axis=0)
        if k < FIRST:
            d = d + SHARE * np.log((rows + reach) / (columns + sight))
            continue
        slope = columns - rows + sight - reach
        H = 2 * (np.diag(rows + columns) - E - E.T) + 4 * np.diag(reach + sight)
        by = 1 / np.sqrt(np.diagonal(H))
        even = H * by[:, None] * by[None, :] + 1e-13 * np.eye(n)
        step = -by * np.linalg.solve(even, by * slope)
        longest = np.abs(step).max(initial=0.0)
        d = d + step * min(1.0, LONGEST / max(longest, LONGEST))
        if longest < 1e-2:
            break
    return d

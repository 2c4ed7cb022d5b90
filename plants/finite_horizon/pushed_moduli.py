"""Integrals of |c Phi(t, s) E_j(s)| over s up to many times t of a motion at once: what bounded disturbances can do.

Backward by the adjoint, CHAIN stretches at a time: with r the rows at the end of a chain and L_k the product of the
transitions behind its k-th stretch, the rows at the start of that are r L_k Phi_k and what w held over it does is
r L_k Gamma_k. One product of r with all these columns serves the chain. Rows that begin within a chain go from stretch
to stretch.
"""

from __future__ import annotations

import numpy as np

from .stretches import ACROSS, Stretches

Array = np.ndarray
CHAIN = 24  # stretches
CURVED = ACROSS**2 / 8  # of its height, that a swing may be off the straight line between the ends of a stretch
NEAR = 4  # stretches that hold a quarter of the fastest swing
ROWS = 500_000  # numbers kept at once


def pushed_moduli(on: Stretches, at: Array, sees: Array) -> Array:
    """(nk, nz, nw) the integral of |sees Phi(t, s) E(s)| up to each t[at], ascending, of sees (nk, nz, n)."""
    last, (count, nz, _) = int(at[-1]), sees.shape
    until, total = np.repeat(at, nz), np.zeros((count * nz, on.nw))
    length = max(2 * NEAR, ROWS // (count * nz * on.nw))
    going = _Backward(on, at, sees, length)
    for top in range(last, 0, -length):
        going.down_to(max(top - length - NEAR, 0), top)
        low = max(top - length, 0)
        live = going.begun * nz
        if live < len(total):
            begin, end = low - going.base, top - going.base
            held, f = going.held[live:, :, begin:end], going.ends[live:, :, begin : end + 2 * NEAR + 1]
            total[live:] += _moduli(held, f, on.h[low:top], until[live:] - low)
    return total.reshape(count, nz, on.nw)


class _Backward:
    """Rows going backward; `held` (rows, nw, length + NEAR) of stretches from `base` on, `ends` (.., NEAR more at both
    sides) of c Phi(t, s) E(s) at their ends, zero where a row has not begun."""

    def __init__(self, on: Stretches, at: Array, sees: Array, length: int) -> None:
        rows = len(at) * sees.shape[1]
        self.on, self.at, self.sees, self.length = on, at, sees, length
        self.rows = np.zeros((rows, on.n))
        self.held = np.zeros((rows, on.nw, length + NEAR))
        self.ends = np.zeros((rows, on.nw, length + 3 * NEAR + 1))
        self.begun, self.now = len(at), int(at[-1])  # rows are those at the end `now`
        self.base = self.now - length - NEAR
        self._begin(self.now)
        self._powers: tuple[int, Array] = (-1, np.zeros(0))

    def down_to(self, low: int, top: int) -> None:
        """Stretches from `low` on are known, `top` the end of the last that is asked for."""
        shift = top - self.length - NEAR - self.base
        if shift:  # what is known of the part before moves to its end
            for kept in (self.held, self.ends):
                kept[..., -shift:] = kept[..., :shift].copy()
                kept[..., :-shift] = 0.0
            self.base += shift
        while self.now > low:
            self._chain(low)

    def _begin(self, k: int) -> None:
        """Rows that begin at the end k."""
        nz = self.sees.shape[1]
        while self.begun and self.at[self.begun - 1] == k:
            self.begun -= 1
            own = slice(self.begun * nz, (self.begun + 1) * nz)
            self.rows[own] = self.sees[self.begun]
            self.ends[own, :, k - self.base + NEAR] = self.rows[own] @ self.on.nodes[0][k]

    def _chain(self, low: int) -> None:
        on, nz, high = self.on, self.sees.shape[1], self.now
        begin = max(high - CHAIN, low, int(on.first[on.group[high - 1]]) if on.alike else 0)
        size, n, old = high - begin, on.n, self.begun * nz
        if old < len(self.rows):
            found = self.rows[old:] @ self._columns(begin, high)
            i, w = begin - self.base, size * on.nw
            self.held[old:, :, i : i + size] = found[:, n : n + w].reshape(-1, on.nw, size)
            self.ends[old:, :, i + NEAR : i + NEAR + size] = found[:, n + w :].reshape(-1, on.nw, size)
            self.rows[old:] = found[:, :n]
        if self.begun and self.at[self.begun - 1] >= begin:
            for k in range(high - 1, begin - 1, -1):
                new, g = slice(self.begun * nz, old), on.group[k]
                if self.begun * nz < old:
                    self.held[new, :, k - self.base] = self.rows[new] @ on.moves[1][g]
                    self.rows[new] = self.rows[new] @ on.moves[0][g]
                    self.ends[new, :, k - self.base + NEAR] = self.rows[new] @ on.nodes[0][k]
                self._begin(k)
        self.now = begin

    def _columns(self, begin: int, end: int) -> Array:
        """[Phi over the chain, L_k Gamma_k .., L_k Phi_k E_k ..] (n, n + 2 nw (end - begin))."""
        on, groups, (Phi, Gamma) = self.on, self.on.group[begin:end], self.on.moves
        if self._powers[0] != groups[0] or not on.alike or len(self._powers[1]) <= end - begin:
            L = np.empty((end - begin + 1, on.n, on.n))
            L[0] = np.eye(on.n)
            for i, g in enumerate(groups[::-1]):
                np.matmul(L[i], Phi[g], out=L[i + 1])
            self._powers = int(groups[0]), L
        L = self._powers[1][: end - begin + 1]
        held, ends = (L[:-1] @ Gamma[groups[::-1]])[::-1], (L[1:] @ on.nodes[0][begin:end][::-1])[::-1]
        columns = (M.transpose(1, 2, 0).reshape(on.n, -1) for M in (held, ends))
        return np.concatenate([L[-1], *columns], axis=1)


def _moduli(held: Array, f: Array, h: Array, until: Array) -> Array:
    """(rows, nw) the integrals of |f| over stretches h (k,), from those of f (rows, nw, k) and f at their ends, NEAR
    more on both sides; of each row those before `until` (rows,).

    Over a stretch in which f keeps its sign the integral of its modulus is that of itself. Where it does not, or may
    not, the straight line between its ends serves, with what the second derivative may add.
    """
    k, size = len(h), np.abs(f)
    found = np.abs(held).sum(axis=-1)
    negative, small = f[..., NEAR : NEAR + k + 1] < 0, _small(size)[..., NEAR : NEAR + k + 1]
    doubted = negative[..., 1:] != negative[..., :-1]
    doubted |= small[..., 1:]
    doubted |= small[..., :-1]
    r, j, s = np.nonzero(doubted)
    within = s < until[r]
    r, j, s = r[within], j[within], s[within]
    about = size[r, j, s]
    for d in range(1, 2 * NEAR + 2):
        np.maximum(about, size[r, j, s + d], out=about)
    first, second = f[r, j, s + NEAR], f[r, j, s + NEAR + 1]
    whole, a, b, curved = np.abs(held[r, j, s]), np.abs(first), np.abs(second), CURVED * about
    crosses = (first * second < 0) | (np.minimum(a, b) <= curved)
    line = (a**2 + b**2) / (2 * np.maximum(a + b, np.finfo(float).tiny)) + curved
    more = np.where(crosses, np.maximum(h[s] * line - whole, 0.0), 0.0)
    added = np.bincount(r * held.shape[1] + j, more, found.size)
    return np.asarray(found + added.reshape(found.shape))


def _small(size: Array) -> Array:
    """Where |f| (rows, nw, k) may be small beside what it is within NEAR stretches and one: none of these is missed."""
    *some, k = size.shape
    parts = -(-k // NEAR)
    padded = np.zeros((*some, parts * NEAR))
    padded[..., :k] = size
    largest = padded[..., ::NEAR].copy()
    for d in range(1, NEAR):
        np.maximum(largest, padded[..., d::NEAR], out=largest)
    about = largest.copy()
    for d in (1, 2):
        np.maximum(about[..., d:], largest[..., :-d], out=about[..., d:])
        np.maximum(about[..., :-d], largest[..., d:], out=about[..., :-d])
    few = padded < np.repeat(1.001 * CURVED * about, NEAR, axis=-1)
    return np.asarray(few[..., :k])

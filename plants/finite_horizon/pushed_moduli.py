"""Integrals of |c Phi(t, s) E_j(s)| over s up to many times t of a motion at once: what bounded disturbances can do.

Backward by the adjoint, CHAIN stretches at a time: with r the rows at the end of a chain, those at the start of its
k-th stretch are r L_k Phi_k and what w held over it does is r L_k Gamma_k, L_k the product of the transitions behind it.
One product of r with all these columns serves the chain. Rows that begin within a chain go from stretch to stretch.
"""

from __future__ import annotations

import numpy as np

from .stretches import ACROSS, Stretches

Array = np.ndarray
CHAIN = 12  # stretches
CURVED = ACROSS**2 / 8  # of its height, that a swing may be off the straight line between the ends of a stretch
NEAR = 4  # stretches that hold a quarter of the fastest swing
ROWS = 500_000  # numbers kept at once


def pushed_moduli(on: Stretches, at: Array, sees: Array) -> Array:
    """(nk, nz, nw) the integral of |sees Phi(t, s) E(s)| up to each t[at], ascending, of sees (nk, nz, n)."""
    last, nz, count = int(at[-1]), on.nz, len(at)
    until, total = np.repeat(at, nz), np.zeros((count * nz, on.nw))
    length = max(2 * NEAR, ROWS // (count * nz * on.nw))
    going = _Backward(on, at, sees, length)
    for top in range(last, 0, -length):
        going.down_to(max(top - length - NEAR, 0), top)
        low = max(top - length, 0)
        live = going.begun * nz
        if live < len(total):
            inside = slice(low - going.base, top - going.base)
            f = going.ends[live:, inside.start : inside.stop + 2 * NEAR + 1]
            total[live:] += _moduli(going.held[live:, inside], f, on.h[low:top], until[live:] - low)
    return total.reshape(count, nz, on.nw)


class _Backward:
    """Rows going backward; `held` (rows, length + NEAR, nw) of stretches from `base` on, `ends` (.., NEAR more at both
    sides, nw) of c Phi(t, s) E(s) at their ends, zero where a row has not begun."""

    def __init__(self, on: Stretches, at: Array, sees: Array, length: int) -> None:
        rows = len(at) * on.nz
        self.on, self.at, self.sees, self.length = on, at, sees, length
        self.rows = np.zeros((rows, on.n))
        self.held = np.zeros((rows, length + NEAR, on.nw))
        self.ends = np.zeros((rows, length + 3 * NEAR + 1, on.nw))
        self.begun, self.now = len(at), int(at[-1])  # rows are those at the end `now`
        self.base = self.now - length - NEAR
        self._begin(self.now)

    def down_to(self, low: int, top: int) -> None:
        """Stretches from `low` on are known, `top` the end of the last that is asked for."""
        shift = top - self.length - NEAR - self.base
        if shift:  # what is known of the part before moves to its end
            for kept in (self.held, self.ends):
                kept[:, -shift:] = kept[:, :shift] if -shift >= kept.shape[1] else kept[:, :shift].copy()
                kept[:, :-shift] = 0.0
            self.base += shift
        while self.now > low:
            self._chain(low)

    def _begin(self, k: int) -> None:
        """Rows that begin at the end k."""
        nz = self.on.nz
        while self.begun and self.at[self.begun - 1] == k:
            self.begun -= 1
            own = slice(self.begun * nz, (self.begun + 1) * nz)
            self.rows[own] = self.sees[self.begun]
            self.ends[own, k - self.base + NEAR] = self.rows[own] @ self.on.nodes[0][k]

    def _chain(self, low: int) -> None:
        on, high, old = self.on, self.now, self.begun * self.on.nz
        begin = max(high - CHAIN, low, int(on.first[on.group[high - 1]]) if on.alike else 0)
        size, n, nw = high - begin, on.n, on.nw
        if old < len(self.rows):
            found = self.rows[old:] @ _columns(on, begin, high)
            i, w = begin - self.base, size * nw
            self.held[old:, i : i + size] = found[:, n : n + w].reshape(-1, size, nw)
            self.ends[old:, i + NEAR : i + NEAR + size] = found[:, n + w :].reshape(-1, size, nw)
            self.rows[old:] = found[:, :n]
        for k in range(high - 1, begin - 1, -1):
            new, g = slice(self.begun * on.nz, old), on.group[k]
            if self.begun * on.nz < old:
                self.held[new, k - self.base] = self.rows[new] @ on.moves[1][g]
                self.rows[new] = self.rows[new] @ on.moves[0][g]
                self.ends[new, k - self.base + NEAR] = self.rows[new] @ on.nodes[0][k]
            self._begin(k)
        self.now = begin


def _columns(on: Stretches, begin: int, end: int) -> Array:
    """[Phi over the chain, L_k Gamma_k .., L_k Phi_k E_k ..] (n, n + 2 nw (end - begin))."""
    (Phi, Gamma), E, L = on.moves, on.nodes[0], np.eye(on.n)
    helds, ends = [], []
    for k in range(end - 1, begin - 1, -1):
        g = on.group[k]
        helds.append(L @ Gamma[g])
        L = L @ Phi[g]
        ends.append(L @ E[k])
    return np.concatenate([L, *helds[::-1], *ends[::-1]], axis=1)


def _moduli(held: Array, f: Array, h: Array, until: Array) -> Array:
    """(rows, nw) the integrals of |f| over stretches h (k,), from those of f (rows, k, nw) and f at their ends, NEAR
    more on both sides; of each row those before `until` (rows,).

    Over a stretch in which f keeps its sign the integral of its modulus is that of itself. Where it does not, or may
    not, the straight line between its ends serves, with what the second derivative may add.
    """
    k, size = len(h), np.abs(f)
    found = np.abs(held).sum(axis=1)
    negative = f[:, NEAR : NEAR + k + 1] < 0
    doubted = negative[:, 1:] != negative[:, :-1]
    small = _small(size)[:, NEAR : NEAR + k + 1]
    doubted |= small[:, 1:]
    doubted |= small[:, :-1]
    r, s, j = np.nonzero(doubted)
    within = s < until[r]
    r, s, j = r[within], s[within], j[within]
    about = size[r, s, j]
    for d in range(1, 2 * NEAR + 2):
        np.maximum(about, size[r, s + d, j], out=about)
    first, second = f[r, s + NEAR, j], f[r, s + NEAR + 1, j]
    whole, a, b, curved = np.abs(held[r, s, j]), np.abs(first), np.abs(second), CURVED * about
    crosses = (first * second < 0) | (np.minimum(a, b) <= curved)
    line = (a**2 + b**2) / (2 * np.maximum(a + b, np.finfo(float).tiny)) + curved
    more = np.where(crosses, np.maximum(h[s] * line - whole, 0.0), 0.0)
    added = np.bincount(r * held.shape[-1] + j, more, found.size)
    return np.asarray(found + added.reshape(found.shape))


def _small(size: Array) -> Array:
    """Where |f| (rows, k, nw) may be small beside what it is within NEAR stretches and one: none of these is missed."""
    rows, k, nw = size.shape
    parts = -(-k // NEAR)
    padded = np.zeros((rows, parts * NEAR, nw))
    padded[:, :k] = size
    padded = padded.reshape(rows, parts, NEAR, nw)
    largest = padded.max(axis=2)
    about = largest.copy()
    for d in (1, 2):
        np.maximum(about[:, d:], largest[:, :-d], out=about[:, d:])
        np.maximum(about[:, :-d], largest[:, d:], out=about[:, :-d])
    few = padded < 1.001 * CURVED * about[:, :, None]
    return np.asarray(few.reshape(rows, -1, nw)[:, :k])

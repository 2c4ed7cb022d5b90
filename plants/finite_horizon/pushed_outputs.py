"""How far disturbances and deviations at the start can push outputs at each time of a motion, and which do.

Of unit energy       |z_i(t)| <= sqrt(c_i W(t) c_i'), W the Gramian of what is reached; the disturbance that attains it
                     is w(s) = E(s)' Phi(t, s)' c_i' / sqrt(..)
Bounded, |w_j| <= l_j  |z_i(t)| <= sum of l_j times the integral of |c_i Phi(t, s) E_j(s)| over s, attained by its signs
White, of unit intensity, and a start of covariance P0: the standard deviation sqrt(c_i (W + Phi P0 Phi') c_i')
"""

from __future__ import annotations

import numpy as np

from pliant.plants.linear.ltv import splined

from .stretches import ACROSS, Stretches

Array = np.ndarray
BETWEEN = (0.2, 0.4, 0.6, 0.8)  # parts of a stretch
STEADY = 1e-3  # by which C and F may be larger within a stretch than at its ends, and yet not be looked at there
CURVED = ACROSS**2 / 8  # of its height, that a swing may be off the straight line between the ends of a stretch
NEAR = 4  # stretches that hold a quarter of the fastest swing
WORK, FEWEST_LOOKED = 4e8, 40  # multiplications, and times, for what bounded disturbances can do
ROWS = 500_000  # numbers kept at once


def gramians(on: Stretches, start: Array | None = None) -> Array:
    """W (m + 1, n, n) at the ends of stretches; `start` (n, n): its value at the first."""
    Phi, step = on.held[0], on.gramians
    W = np.zeros((len(on.h) + 1, on.n, on.n))
    if start is not None:
        W[0] = start
    for k in range(len(on.h)):
        W[k + 1] = Phi[k] @ W[k] @ Phi[k].T + step[k]
    return W


def by_energy(on: Stretches, W: Array) -> tuple[Array, Array]:
    """The most that |z_i| can be at each end of a stretch (m + 1, nz), and what it is at most on the stretch before it.

    Between the ends W is a cubic of its rates there, to within the fourth derivative's share, (2 |lambda| h)^4/384 of
    the largest; C is what it is. What passes through without delay (F) has no bound at one time: it is left out of the
    first, and makes the second infinite.
    """
    (E, C, F), (early, late), h = on.nodes, on.rates, on.h[:, None]
    squares = np.maximum(_quadratic(C, W), 0.0)
    within = [squares[:-1], squares[1:]]
    for s in BETWEEN:  # the cubic through values and slopes at both ends
        first, last = (1 + 2 * s) * (1 - s) ** 2, s**2 * (3 - 2 * s)
        sees = on.between(s)[0]
        begin = 2 * _quadratic(sees, W[:-1], sees @ early) + np.square(sees @ E[:-1]).sum(axis=-1)
        end = 2 * _quadratic(sees, W[1:], sees @ late) + np.square(sees @ E[1:]).sum(axis=-1)
        values = first * _quadratic(sees, W[:-1]) + last * _quadratic(sees, W[1:])
        within.append(values + h * (s * (1 - s) ** 2 * begin - s**2 * (1 - s) * end))
    error = (2 * ACROSS) ** 4 / 384 * squares.max(axis=0)
    upper = np.vstack([squares[:1], np.max(within, axis=0) + error])
    upper[:, np.abs(F).max(axis=(0, 2)) > 0] = np.inf
    return np.sqrt(squares), np.sqrt(np.maximum(upper, 0.0))


def _quadratic(sees: Array, W: Array, other: Array | None = None) -> Array:
    """(m, nz) c_i W d_i' of the rows c_i of `sees` and d_i of `other`, `sees` itself if not given."""
    return np.asarray(((sees @ W) * (sees if other is None else other)).sum(axis=-1))


def backward(on: Stretches, at: int, row: int) -> Array:
    """c Phi(t, s) at the starts of stretches before t = t[at], (at + 1, n); the last is c itself."""
    Phi, found = on.held[0], np.zeros((at + 1, on.n))
    found[at] = on.nodes[1][at, row]
    for k in range(at - 1, -1, -1):
        found[k] = found[k + 1] @ Phi[k]
    return found


def worst_of_energy(on: Stretches, at: int, row: int) -> tuple[Array, float]:
    """The disturbance (m + 1, nw) of unit energy, held from row to row, that pushes z_row most at t[at]; how far."""
    later, Gamma = backward(on, at, row), on.held[1]
    found = np.zeros((len(on.t), on.nw))
    effect = np.einsum("ki,kij->kj", later[1:], Gamma[:at])  # of w held at one
    found[:at] = effect / on.h[:at, None]
    size = float(np.sqrt((np.square(found[:-1]) * on.h[:, None]).sum()))
    return (found / size if size > 0 else found), size


def worst_bounded(on: Stretches, at: int, row: int, limits: Array) -> tuple[Array, float]:
    """The disturbance (m + 1, nw) of +-limits (nw,) that pushes z_row furthest at t[at]; how far."""
    later, Gamma, through = backward(on, at, row), on.held[1], on.nodes[2][at, row]
    effect = np.einsum("ki,kij->kj", later[1:], Gamma[:at])
    found = np.zeros((len(on.t), on.nw))
    found[:at], found[at] = np.where(effect < 0, -1.0, 1.0), np.where(through < 0, -1.0, 1.0)
    return found * limits, float((np.abs(effect).sum(axis=0) + np.abs(through)) @ limits)


def looked_at(on: Stretches) -> Array:
    """Ends of stretches (nk,) at which what bounded disturbances can do is found: all, where that is little work."""
    m = len(on.h)
    work = m * on.nz * on.n * (on.n + on.nw)  # of each, half of it in the mean
    count = m + 1 if m + 1 <= WORK / work else max(int(WORK / work), FEWEST_LOOKED)
    return np.unique(np.linspace(0, m, min(count, m + 1)).round().astype(int))


def by_bounded(on: Stretches, limits: Array, at: Array) -> tuple[Array, Array]:
    """At most how far |z_i| can be where |w_j| <= limits (nw,): at the ends `at` (nk,) of stretches (nk, nz), and at
    most (nz,) at other times, where C or F are larger within a stretch than at its ends.

    By the adjoint: c Phi(t, s) from each t backward. Over a stretch in which c Phi(t, s) E_j(s) keeps its sign the
    integral of its modulus is that of itself. Where it does not, or may not, the straight line between its ends
    serves, with what the second derivative may add.
    """
    found = (_pushed_at(on, at, on.nodes[1][at]) + np.abs(on.nodes[2][at])) @ limits
    beside, looked, more = np.zeros(on.nz), set(at.tolist()), []
    for k, values in _larger_within(on).items():  # what stands between moves as at the nearer end
        more += [(end, *value) for end in {k, k + 1} & looked for value in values]
    if more:
        more.sort(key=lambda one: one[0])
        pushed = _pushed_at(on, np.array([m[0] for m in more]), np.array([m[1] for m in more]))
        beside = ((pushed + np.abs(np.array([m[2] for m in more]))) @ limits).max(axis=0)
    return found, beside


def _pushed_at(on: Stretches, at: Array, sees: Array) -> Array:
    """(nk, nz, nw) the integral of |sees Phi(t, s) E(s)| up to each t[at], ascending, of sees (nk, nz, n)."""
    (Phi, Gamma), E, nz, count = on.held, on.nodes[0], on.nz, len(at)
    last, rows, begun = int(at[-1]), np.zeros((count * nz, on.n)), count
    total, until = np.zeros((count * nz, on.nw)), np.repeat(at, nz)
    block = max(2 * NEAR, ROWS // (count * nz * on.nw))
    held, ends = np.zeros((block + NEAR, *total.shape)), np.zeros((block + 2 * NEAR + 1, *total.shape))
    top = last  # the last stretch of the block is top - 1; ends[i] belongs to k = top - block - NEAR + i
    kept = 0  # of the latest ends, already known
    while top > 0:
        base = top - block - NEAR
        for k in range(top - kept, max(base, 0) - 1, -1):
            if k < last:
                live = rows[begun * nz :]
                if k - base < len(held):
                    held[k - base, begun * nz :] = live @ Gamma[k]
                rows[begun * nz :] = live @ Phi[k]
            while begun and at[begun - 1] == k:
                begun -= 1
                rows[begun * nz : (begun + 1) * nz] = sees[begun]
            ends[k - base, begun * nz :] = rows[begun * nz :] @ E[k]
        first = max(top - block, 0)
        whole, f = held[first - base : top - base], ends[first - base : top - base + 1]
        live_at = until[None, :, None] > np.arange(first, top)[:, None, None]
        total += np.where(
            live_at, _moduli(whole, f, _about(ends)[first - base : top - base], on.h[first:top]), 0.0
        ).sum(axis=0)
        later = ends[: 2 * NEAR + 1].copy(), held[:NEAR].copy()
        ends[:], held[:] = 0.0, 0.0
        ends[block:], held[block:] = later
        top, kept = top - block, NEAR + 1
    return total.reshape(count, nz, on.nw)


def _moduli(held: Array, f: Array, about: Array, h: Array) -> Array:
    """(k, .., nw) the integral of |f| over each stretch from that of f (k, .., nw), f (k + 1, .., nw) at their ends."""
    whole, size = np.abs(held), np.abs(f)
    a, b, curved = size[:-1], size[1:], CURVED * about
    crosses = (f[:-1] * f[1:] < 0) | (np.minimum(a, b) <= curved)
    line = (a**2 + b**2) / (2 * np.maximum(a + b, np.finfo(float).tiny)) + curved
    return np.asarray(np.where(crosses, np.maximum(whole, h[:, None, None] * line), whole))


def _about(f: Array) -> Array:
    """The largest |f| (k + 1, ..) within NEAR ends of a stretch, the height of its swing, (k, ..)."""
    size = np.abs(f)
    found = np.maximum(size[:-1], size[1:])
    for _ in range(NEAR):
        wider = found.copy()
        wider[1:] = np.maximum(wider[1:], found[:-1])
        wider[:-1] = np.maximum(wider[:-1], found[1:])
        found = wider
    return found


def _larger_within(on: Stretches) -> dict[int, list[tuple[Array, Array]]]:
    """C and F at times within stretches where they are larger than at the ends, by the stretch."""
    _, C, F = on.nodes
    found: dict[int, list[tuple[Array, Array]]] = {}
    for share in BETWEEN:
        sees, through = on.between(share)
        more = np.zeros(len(on.h), dtype=bool)
        for inner, at in ((sees, C), (through, F)):
            most = np.maximum(np.abs(at[:-1]), np.abs(at[1:]))
            more |= (np.abs(inner) > most + STEADY * np.abs(at).max(axis=0, initial=0.0)).any(axis=(1, 2))
        for k in np.flatnonzero(more):
            found.setdefault(int(k), []).append((sees[k], through[k]))
    return found


def from_start(on: Stretches, sizes: Array) -> Array:
    """|c_i Phi(t, 0) X| at the ends of stretches (m + 1, nz), X = diag(sizes)."""
    Phi, C = on.held[0], on.nodes[1]
    moved, found = np.diag(sizes), np.zeros((len(on.t), on.nz))
    found[0] = np.linalg.norm(C[0] @ moved, axis=1)
    for k in range(len(Phi)):
        moved = Phi[k] @ moved
        found[k + 1] = np.linalg.norm(C[k + 1] @ moved, axis=1)
    return found


def nominal(on: Stretches, rows: list[int]) -> Array:
    """The nominal's states and outputs of these rows of [x; y] at the ends of stretches, (m + 1, nz)."""
    model = on.model
    return splined(model.t, np.concatenate([model.x, model.y], axis=1)[:, rows], on.t)

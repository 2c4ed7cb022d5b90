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
WORK, FEWEST_LOOKED = 4e9, 60  # multiplications, and times, for what bounded disturbances can do
ROWS = 20_000_000  # numbers kept at once


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
    A, E, C, F = on.nodes
    squares = np.maximum(np.einsum("kij,kjl,kil->ki", C, W, C), 0.0)
    rate = A @ W + W @ np.swapaxes(A, 1, 2) + E @ np.swapaxes(E, 1, 2)
    within, h = [squares[:-1], squares[1:]], on.h[:, None, None]
    for share in BETWEEN:
        between = _hermite(share, W, h * rate[:-1], h * rate[1:])
        sees = on.between(share)[2]
        within.append(np.einsum("kij,kjl,kil->ki", sees, between, sees))
    error = (2 * ACROSS) ** 4 / 384 * squares.max(axis=0)
    upper = np.vstack([squares[:1], np.max(within, axis=0) + error])
    upper[:, np.abs(F).max(axis=(0, 2)) > 0] = np.inf
    return np.sqrt(squares), np.sqrt(np.maximum(upper, 0.0))


def _hermite(s: float, y: Array, begin: Array, end: Array) -> Array:
    """Between rows of y, at the part s of each stretch, from slopes times its length at its start and its end."""
    first, last = (1 + 2 * s) * (1 - s) ** 2, s**2 * (3 - 2 * s)
    return first * y[:-1] + last * y[1:] + s * (1 - s) ** 2 * begin - s**2 * (1 - s) * end


def backward(on: Stretches, at: int, row: int) -> Array:
    """c Phi(t, s) at the starts of stretches before t = t[at], (at + 1, n); the last is c itself."""
    Phi, found = on.held[0], np.zeros((at + 1, on.n))
    found[at] = on.nodes[2][at, row]
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
    later, Gamma, through = backward(on, at, row), on.held[1], on.nodes[3][at, row]
    effect = np.einsum("ki,kij->kj", later[1:], Gamma[:at])
    found = np.zeros((len(on.t), on.nw))
    found[:at], found[at] = np.where(effect < 0, -1.0, 1.0), np.where(through < 0, -1.0, 1.0)
    return found * limits, float((np.abs(effect).sum(axis=0) + np.abs(through)) @ limits)


def looked_at(on: Stretches) -> Array:
    """Ends of stretches (nk,) at which what bounded disturbances can do is looked at: all, where that is little work."""
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
    found, beside, within = np.zeros((len(at), on.nz)), np.zeros(on.nz), _larger_within(on)
    size = max(1, ROWS // ((len(on.h) + 1) * on.nz * on.nw))
    for first in range(0, len(at), size):
        part = at[first : first + size]
        found[first : first + size] = _pushed_at(on, part, on.nodes[2][part]) @ limits
    found += np.abs(on.nodes[3][at]) @ limits
    looked = set(at.tolist())
    for k, values in within.items():  # what stands between moves as at the nearer end
        for end in {k, k + 1} & looked:
            for sees, through in values:
                pushed = _pushed_at(on, np.array([end]), sees[None])[0] @ limits
                beside = np.maximum(beside, pushed + np.abs(through) @ limits)
    return found, beside


def _pushed_at(on: Stretches, at: Array, sees: Array) -> Array:
    """(nk, nz, nw) the integral of |sees Phi(t, s) E(s)| up to each t[at], sees (nk, nz, n)."""
    (Phi, Gamma), E, last = on.held, on.nodes[1], int(at.max(initial=0))
    count, held = len(at), np.zeros((len(at), on.nz, last, on.nw))
    ends = np.zeros((count, on.nz, last + 1, on.nw))
    rows, begun = np.zeros((count * on.nz, on.n)), count
    for k in range(last, -1, -1):
        if k < last:
            live = rows[begun * on.nz :]
            held[begun:, :, k] = (live @ Gamma[k]).reshape(count - begun, on.nz, on.nw)
            rows[begun * on.nz :] = live @ Phi[k]
        while begun and at[begun - 1] == k:
            begun -= 1
            rows[begun * on.nz : (begun + 1) * on.nz] = sees[begun]
        ends[begun:, :, k] = (rows[begun * on.nz :] @ E[k]).reshape(count - begun, on.nz, on.nw)
    found = np.zeros((count, on.nz, on.nw))
    for i, end in enumerate(at):
        found[i] = _pushed(held[i, :, :end], ends[i, :, : end + 1], on.h[:end, None])
    return found


def _pushed(held: Array, f: Array, h: Array) -> Array:
    """(nz, nw) the integral of |f| from that of f over each stretch (nz, k, nw) and from f at its ends."""
    whole, size = np.abs(held), np.abs(f)
    a, b, curved = size[:, :-1], size[:, 1:], CURVED * _about(size)
    crosses = (f[:, :-1] * f[:, 1:] < 0) | (np.minimum(a, b) <= curved)
    line = (a**2 + b**2) / (2 * np.maximum(a + b, np.finfo(float).tiny)) + curved
    return np.asarray(np.where(crosses, np.maximum(whole, h * line), whole).sum(axis=1))


def _larger_within(on: Stretches) -> dict[int, list[tuple[Array, Array]]]:
    """C and F at times within stretches where they are larger than at the ends, by the stretch."""
    _, _, C, F = on.nodes
    found: dict[int, list[tuple[Array, Array]]] = {}
    for share in BETWEEN:
        _, _, sees, through = on.between(share)
        more = np.zeros(len(on.h), dtype=bool)
        for inner, at in ((sees, C), (through, F)):
            most = np.maximum(np.abs(at[:-1]), np.abs(at[1:]))
            more |= (np.abs(inner) > most + STEADY * np.abs(at).max(axis=0, initial=0.0)).any(axis=(1, 2))
        for k in np.flatnonzero(more):
            found.setdefault(int(k), []).append((sees[k], through[k]))
    return found


def _about(f: Array) -> Array:
    """The largest of f (nz, k + 1, nw) within NEAR ends of a stretch, the height of its swing, (nz, k, nw)."""
    found = np.maximum(f[:, :-1], f[:, 1:])
    for _ in range(NEAR):
        wider = found.copy()
        wider[:, 1:] = np.maximum(wider[:, 1:], found[:, :-1])
        wider[:, :-1] = np.maximum(wider[:, :-1], found[:, 1:])
        found = wider
    return found


def from_start(on: Stretches, sizes: Array) -> Array:
    """|c_i Phi(t, 0) X| at the ends of stretches (m + 1, nz), X = diag(sizes)."""
    Phi, C = on.held[0], on.nodes[2]
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

"""How far disturbances and deviations at the start can push outputs at each time of a motion, and which do.

Of unit energy       |z_i(t)| <= sqrt(c_i W(t) c_i'), W the Gramian of what is reached; the disturbance that attains it
                     is w(s) = E(s)' Phi(t, s)' c_i' / sqrt(..)
Bounded, |w_j| <= l_j  |z_i(t)| <= sum of l_j times the integral of |c_i Phi(t, s) E_j(s)| over s, attained by its signs
White, of unit intensity, and a start of covariance P0: the standard deviation sqrt(c_i (W + Phi P0 Phi') c_i')
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pliant.plants.linear.ltv import splined

from .pushed_moduli import pushed_moduli
from .stretches import ACROSS, Stretches

Array = np.ndarray
BETWEEN = (0.2, 0.4, 0.6, 0.8)  # parts of a stretch
STEADY = 1e-3  # by which C and F may be larger within a stretch than at its ends, and yet not be looked at there
KEPT = 500_000  # numbers of W at once
WORK, FEWEST_LOOKED = 4e8, 40  # multiplications, and times, for what bounded disturbances can do


def gramians(on: Stretches, start: Array | None = None) -> Array:
    """W (m + 1, n, n) at the ends of stretches; `start` (n, n): its value at the first."""
    found = np.empty((len(on.h) + 1, on.n, on.n))
    for begin, W in _gramians(on, start):
        found[begin : begin + len(W)] = W
    return found


def _gramians(on: Stretches, start: Array | None = None) -> Iterator[tuple[int, Array]]:
    """The same some at a time: the first end's place, and W (.., n, n) from it to that of the next part."""
    Phi, step, m = on.moves[0], on.reached, len(on.h)
    count = max(16, KEPT // on.n**2)
    W = np.zeros((count + 1, on.n, on.n))
    if start is not None:
        W[0] = start
    for begin in range(0, m, count):
        groups = on.group[begin : begin + count].tolist()
        for k, g in enumerate(groups):
            W[k + 1] = Phi[g] @ W[k] @ Phi[g].T + step[g]
        yield begin, W[: len(groups) + 1]
        W[0] = W[len(groups)]


def by_energy(on: Stretches) -> tuple[Array, Array]:
    """The most that |z_i| can be at each end of a stretch (m + 1, nz), and what it is at most on the stretch before it.

    Between the ends W is a cubic of its rates there, to within the fourth derivative's share, (2 |lambda| h)^4/384 of
    the largest; C is what it is. What passes through without delay (F) has no bound at one time: it is left out of the
    first, and makes the second infinite.
    """
    (E, C, F), m, nz = on.nodes, len(on.h), on.nz
    between = np.concatenate([on.between(s)[0] for s in BETWEEN], axis=1)  # (m, 4 nz, n)
    early, late = on.rates(between)
    squares, upper = np.zeros((m + 1, nz)), np.zeros((m + 1, nz))
    for begin, W in _gramians(on):
        own, ends = slice(begin, begin + len(W) - 1), slice(begin, begin + len(W))
        sees, h = between[own], on.h[own, None]
        squares[ends] = np.maximum(_quadratic(C[ends], W), 0.0)
        before, after = sees @ W[:-1], sees @ W[1:]
        drives = (np.square(sees @ E[at]).sum(axis=-1) for at in (own, slice(begin + 1, begin + len(W))))
        slopes = [2 * (w * rate[own]).sum(axis=-1) + d for w, rate, d in zip((before, after), (early, late), drives)]
        values = [(w * sees).sum(axis=-1) for w in (before, after)]
        most = np.maximum(squares[own], squares[begin + 1 : begin + len(W)])
        for i, s in enumerate(BETWEEN):  # the cubic through values and slopes at both ends
            a, b, rise, fall = (v[:, i * nz : (i + 1) * nz] for v in (*values, *slopes))
            cubic = (1 + 2 * s) * (1 - s) ** 2 * a + s**2 * (3 - 2 * s) * b
            most = np.maximum(most, cubic + h * (s * (1 - s) ** 2 * rise - s**2 * (1 - s) * fall))
        upper[begin + 1 : begin + len(W)] = most
    upper[1:] += (2 * ACROSS) ** 4 / 384 * squares.max(axis=0)
    upper[0] = squares[0]
    upper[:, np.abs(F).max(axis=(0, 2)) > 0] = np.inf
    return np.sqrt(squares), np.sqrt(np.maximum(upper, 0.0))


def _quadratic(sees: Array, W: Array) -> Array:
    """(m, nz) c_i W c_i' of the rows c_i of `sees`."""
    return np.asarray(((sees @ W) * sees).sum(axis=-1))


def backward(on: Stretches, at: int, row: int) -> Array:
    """c Phi(t, s) at the starts of stretches before t = t[at], (at + 1, n); the last is c itself."""
    Phi, found = on.moves[0], np.zeros((at + 1, on.n))
    found[at] = on.nodes[1][at, row]
    for k, g in zip(range(at - 1, -1, -1), on.group[:at][::-1].tolist()):
        found[k] = found[k + 1] @ Phi[g]
    return found


def _effect(on: Stretches, at: int, row: int) -> Array:
    """(at, nw) of disturbances held at one over each stretch before t[at], on z_row there."""
    later, Gamma = backward(on, at, row)[1:], on.moves[1]
    if not on.alike:
        return np.einsum("ki,kij->kj", later, Gamma[:at])
    return np.asarray((later[:, None] @ Gamma[on.group[:at]])[:, 0])


def worst_of_energy(on: Stretches, at: int, row: int) -> tuple[Array, float]:
    """The disturbance (m + 1, nw) of unit energy, held from row to row, that pushes z_row most at t[at]; how far."""
    effect, found = _effect(on, at, row), np.zeros((len(on.t), on.nw))
    found[:at] = effect / on.h[:at, None]
    size = float(np.sqrt((np.square(found[:-1]) * on.h[:, None]).sum()))
    return (found / size if size > 0 else found), size


def worst_bounded(on: Stretches, at: int, row: int, limits: Array) -> tuple[Array, float]:
    """The disturbance (m + 1, nw) of +-limits (nw,) that pushes z_row furthest at t[at]; how far."""
    effect, through, found = _effect(on, at, row), on.nodes[2][at, row], np.zeros((len(on.t), on.nw))
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
    (_, C, F), more, looked = on.nodes, [], set(at.tolist())
    found = (pushed_moduli(on, at, C[at]) + np.abs(F[at])) @ limits
    beside = np.zeros(found.shape[1])
    for k, values in _larger_within(on).items():  # what stands between moves as at the nearer end
        more += [(end, *value) for end in {k, k + 1} & looked for value in values]
    if more:
        more.sort(key=lambda one: one[0])
        pushed = pushed_moduli(on, np.array([m[0] for m in more]), np.array([m[1] for m in more]))
        beside = ((pushed + np.abs(np.array([m[2] for m in more]))) @ limits).max(axis=0)
    return found, beside


def bounded_at(on: Stretches, limits: Array, at: Array, row: Array) -> Array:
    """(nk,) the same of one output each, z_row at the end `at` of a stretch, at (nk,), row (nk,)."""
    (_, C, F), order, found = on.nodes, np.argsort(at, kind="stable"), np.empty(len(at))
    at, row = at[order], row[order]
    found[order] = (pushed_moduli(on, at, C[at, row][:, None])[:, 0] + np.abs(F[at, row])) @ limits
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

"""A box of parameters in parts, in each of which a loop is shown to be stable by norms that follow its parameters.

x[k+1] = A(delta) x[k] is stable for all delta of a part where, with A_c and P_c > 0 of each of its corners and one G,

    [ P_c       A_c' G      ]
    [ G' A_c    G + G' - P_c ]  > 0      at all corners:

the inequality is linear in A and P, and so holds for what lies between them, where x' P(delta) x falls (de Oliveira,
Bernussou and Geromel 1999). P_c are norms in which the corners' own modes fall (`modal_norms`), G = P that of the
middle: what a corner's P_c differs from it counts by its square, so that parts may be large. In coordinates T x,
P = T' T, the matrix is [[P_c, A_c'], [A_c, 2 - P_c]], and its least eigenvalue is the |rest| of A that it stands.

What is not shown is that rest, A less what is linear in each parameter between the corners: it was measured in the
middle of the part and of its sides, and twice the largest that was found stands for it.

The part nearest to the middle of the box is looked at first, and halved where it is not shown: what is shown grows
from there. Parts that norms do not show may be asked about by scalings (`scaled_part`), which cost some hundred looks
and hold for parts many times as large. A continuous loop is mapped to a sampled one by (1 - h A/2)^-1 (1 + h A/2),
stable where it is.

Source   de Oliveira, Bernussou and Geromel 1999, "A new discrete-time robust stability condition", Theorem 2
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np

from pliant.plants.core.imports import linalg

from .modal_norms import lyapunov_norms, modal_norms
from .nearest_instability import growth
from .scaled_part import holds_by_scalings

Array = np.ndarray
TWICE = 2.0  # times the rest that was measured
WAYS = ((modal_norms, 0.6), (lyapunov_norms, 0.5), (modal_norms, 1.0))  # tried one after the other
SMALLEST = 1e-4  # of the box: width of a part that is not halved again


class Parts(NamedTuple):
    """`stood`: of the box, within which all was shown, 1 at most; how many parts were; the largest |rest| / |A| that
    was measured; an instability (k,) that was met, or None; whether looks ran out before all was shown."""

    stood: float
    parts: int
    left: float
    unstable: Array | None
    cut_short: bool = False


def shown(state_matrix: Callable[[Array], Array], count: int, dt: float | None, most: int, work: float = 0.0) -> Parts:
    """Of the box |delta_i| <= 1, by at most so many looks at a part; `work` on scalings: looks for those of 20 rows."""
    seen: dict[bytes, Array] = {}
    raw = state_matrix(np.zeros(count))
    turn = None if dt is not None else _period(raw)

    def at(delta: Array) -> Array:
        key = np.round(delta, 12).tobytes()
        if key not in seen:
            A = state_matrix(delta)
            seen[key] = A if turn is None else _cayley(A, turn)
        return seen[key]

    corners = np.array(list(product((-1.0, 1.0), repeat=count)))
    waiting: list[tuple[float, int, Array, Array]] = [(0.0, 0, np.zeros(count), np.ones(count))]
    parts, left, stood, looked, unstable = 0, 0.0, 1.0, 0, None
    while waiting:
        near, _, centre, half = heapq.heappop(waiting)
        if near >= stood:
            break
        looked += 1
        if looked > most:
            return Parts(near, parts, left, unstable, True)
        if growth(at(centre), 1.0) >= 0:
            size = float(np.abs(centre).max())
            if size < stood:
                stood, unstable = size, centre
        held = _held(at, centre, half, corners)
        if held.holds:
            parts, left = parts + 1, max(left, held.left)
            continue
        if held.worth and work > 0:
            by = holds_by_scalings(at, centre, half)
            work -= by.cost
            if by.holds:
                parts, left = parts + 1, max(left, by.left)
                continue
        if half.max() < SMALLEST:
            return Parts(near, parts, left, unstable)
        i = held.axis
        wide = np.eye(count)[i] * half / 2
        for k, c in enumerate((centre - wide, centre + wide)):
            h = half - np.abs(wide)
            heapq.heappush(waiting, (float(np.maximum(np.abs(c) - h, 0.0).max()), 2 * looked + k, c, h))
    return Parts(stood, parts, left, unstable)


class _Held(NamedTuple):
    holds: bool
    left: float
    axis: int  # along which the loop changes most
    worth: bool = False  # a look by scalings: all corners are stable


def _held(at: Callable[[Array], Array], centre: Array, half: Array, corners: Array) -> _Held:
    middle, values = at(centre), np.array([at(centre + half * d) for d in corners])
    slopes = np.einsum("ci,cnm->inm", corners, values) / len(corners)
    axis = int(np.linalg.norm(slopes, axis=(1, 2)).argmax())
    if max(float(np.abs(np.linalg.eigvals(A)).max()) for A in (middle, *values)) >= 1:
        return _Held(False, 0.0, axis)
    lacks = [middle - values.mean(axis=0)]
    for i in range(len(half)):
        for sign in (-1.0, 1.0):
            side = sign * np.eye(len(half))[i]
            lacks.append(at(centre + half * side) - values[corners[:, i] == sign].mean(axis=0))
    rests = np.array(lacks)
    unit = _units(np.abs(values).max(axis=0))
    ratio = unit / unit[:, None]
    every = np.concatenate([[middle], values, slopes, rests]) * ratio
    count, n = len(values), len(middle)
    for of, how in WAYS:
        if (norms := of(every[: count + 1], how)) is None:
            continue
        seen = norms.T @ every @ norms.inverse
        whole = np.empty((count, 2 * n, 2 * n))
        whole[:, :n, :n], whole[:, n:, n:] = norms.own, 2 * np.eye(n) - norms.own
        whole[:, n:, :n], whole[:, :n, n:] = seen[1 : count + 1], np.swapaxes(seen[1 : count + 1], 1, 2)
        stands = float(np.linalg.eigvalsh(whole)[:, 0].min())
        sizes = np.linalg.norm(seen[count + 1 :], 2, axis=(1, 2))
        axis = int(sizes[: len(half)].argmax())
        if stands > TWICE * float(sizes[len(half) :].max()):
            return _Held(True, float(np.linalg.norm(rests, 2, axis=(1, 2)).max() / np.linalg.norm(middle, 2)), axis)
    return _Held(False, 0.0, axis, True)


def _units(size: Array) -> Array:
    return np.asarray(linalg.matrix_balance(size, permute=False, separate=True)[1][0])


def _period(A: Array) -> float:
    values = np.linalg.eigvals(A)
    return float(2 / max(np.abs(values[(values.real / np.maximum(np.abs(values), 1e-300)).argmax()]), 1e-12))


def _cayley(A: Array, h: float) -> Array:
    one = np.eye(len(A))
    return np.asarray(np.linalg.solve(one - h / 2 * A, one + h / 2 * A))

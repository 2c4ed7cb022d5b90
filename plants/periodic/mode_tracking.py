"""Modes of a family of constant models followed from one member to the next by their shapes, not by their order.

MAC(a, b) = |a^H b|^2 / (a^H a b^H b), of eigenvectors in coordinates that are scaled once for all members; the pairing
of modes with the largest sum of it is taken (Allemang 2003). Where a pair shares little, a member in between is asked
for: shapes that veer turn fast, but continuously.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pliant.plants.linear.modal_analysis import refined as eigenvectors

Array = np.ndarray
STILL = 1e-7  # of the largest |eigenvalue|: an imaginary part below is no oscillation


class Modes(NamedTuple):
    """Of one member: oscillations with a positive frequency."""

    values: Array  # (nm,) complex [1/s]
    shapes: Array  # (n, nm) complex, of unit length


def modes(A: Array) -> Modes:
    """Of A (n, n), slowest first."""
    lam, V, _, _ = eigenvectors(A)
    swing = np.flatnonzero(lam.imag > STILL * np.abs(lam).max(initial=0.0))
    swing = swing[np.argsort(lam[swing].imag, kind="stable")]
    V = V[:, swing]
    return Modes(lam[swing], V / np.linalg.norm(V, axis=0))


def mac(a: Array, b: Array) -> Array:
    """(na, nb) between unit columns."""
    return np.asarray(np.abs(a.conj().T @ b) ** 2)


def followed(before: Modes, after: Modes) -> tuple[Array, Array]:
    """For each mode of `before` its position in `after`, -1 where there is none, and their MAC (nm,)."""
    from scipy.optimize import linear_sum_assignment

    alike = mac(before.shapes, after.shapes)
    rows, columns = linear_sum_assignment(-alike)
    place, share = np.full(len(before.values), -1), np.zeros(len(before.values))
    place[rows], share[rows] = columns, alike[rows, columns]
    return place, share


def track(
    at: Callable[[float], Array], values: Array, least: float, most: int
) -> tuple[list[float], list[Modes], float]:
    """Parameters, modes in one order for all, and the least MAC of a step, from A at `values`; steps whose MAC is below
    `least` are halved, `most` times at most. Modes that are no oscillation somewhere are NaN from there on.
    """
    now, asked = modes(at(float(values[0]))), [(float(v), 0) for v in values[:0:-1]]
    places, found, worst = [float(values[0])], [now], 1.0
    while asked:
        value, depth = asked.pop()
        new = modes(at(value))
        place, share = followed(now, new)
        lost = np.isnan(now.values.real)
        least_here = float(share[~lost & (place >= 0)].min(initial=1.0))
        if least_here < least and depth < most:
            asked += [(value, depth + 1), ((places[-1] + value) / 2, depth + 1)]
            continue
        worst = min(worst, least_here)
        gone = lost | (place < 0)
        shapes = new.shapes[:, np.maximum(place, 0)] if len(new.values) else now.shapes
        kept = new.values[np.maximum(place, 0)] if len(new.values) else now.values
        now = Modes(np.where(gone, np.nan, kept), np.where(gone, now.shapes, shapes))
        places.append(value)
        found.append(now)
    return places, found, worst

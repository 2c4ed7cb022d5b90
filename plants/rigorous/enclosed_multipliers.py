"""How large the largest eigenvalue of a matrix of balls is, of every member: against the unit circle.

Each eigenvalue by Rump's enclosures (Arb's acb_mat_eig_multiple), where they can be told apart; beside them, for
clusters, |M^k|^(1/k) from above and |trace M^k / n|^(1/k) from below, k = 1, 2, 4 .., which need no eigenvectors. Parts
of states that feel each other both ways are judged alone: exact zeros between them make the matrix triangular.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from .balls import ends, flint, midpoint, part, row_sum

POWERS = 16  # squarings


@dataclass(frozen=True)
class Multipliers:
    """Sizes of the largest eigenvalue at least and at most, doubles near each (n,), and how far each may be off."""

    least: float
    most: float
    values: tuple[complex, ...]
    radii: tuple[float, ...]
    neutral: int  # parts of one state that nothing moves by itself: exactly 1


def multipliers(M: Any, groups: list[np.ndarray], neutral: list[np.ndarray]) -> Multipliers:
    """Of M (n, n) in balls; `groups` are states that feel each other both ways, the `neutral` ones are exactly 1."""
    least, most, values, radii = 0.0, 0.0, [1.0 + 0j] * len(neutral), [0.0] * len(neutral)
    for group in groups:
        own = part(M, group)
        roots = _enclosed(own)
        low, high = (0.0, np.inf) if roots is None else (max(ends(abs(z))[k] for z in roots) for k in (0, 1))
        if roots is None or any(a.overlaps(b) for a, b in combinations(roots, 2)):
            below, above = by_powers(own)
            low, high = max(low, below), min(high, above)
        least, most = max(least, low), max(most, high)
        if roots is None:
            values += [complex(z) for z in np.linalg.eigvals(midpoint(own))]
            radii += [np.inf] * len(group)
            continue
        for z in roots:
            value = complex(float(z.real.mid()), float(z.imag.mid()))
            values.append(value)
            radii.append(ends(abs(z - flint().acb(value.real, value.imag)))[1])
    return Multipliers(least, most, tuple(values), tuple(radii), len(neutral))


def _enclosed(M: Any) -> list[Any] | None:
    """A ball for each eigenvalue, that of a cluster for each of its own; None where Arb finds none."""
    library = flint()
    if M.nrows() == 1:
        return [library.acb(M[0, 0])]
    try:
        return list(library.acb_mat(M).eig(multiple=True))
    except ValueError:
        return None


def by_powers(M: Any) -> tuple[float, float]:
    """Bounds of the largest size of an eigenvalue from the traces and norms of M^k, k = 1, 2, 4 .."""
    low, high, P, k, n = 0.0, np.inf, M, 1, M.nrows()
    for _ in range(POWERS):
        low = max(low, ends((abs(P.trace()) / n).root(k))[0])
        high = min(high, ends(row_sum(P).root(k))[1])
        P, k = P * P, 2 * k
    return low, high

"""The transition matrix over a nominal, enclosed: one Taylor step after the other, in frames that keep errors apart.

Phi(t_k, t_0) = Q_k R_k, Q_k doubles, nearly orthogonal, R_k balls (Lohner's method, 1988): P_k Q_k = Q_k+1 S_k, Q_k+1
from the QR factors of the midpoint, S_k = Q_k+1^-1 P_k Q_k solved in balls, R_k+1 = S_k R_k. S_k is triangular but for
rounding, so that what a fast direction adds to an error stays in it: a product of balls of the P_k themselves is
wrapped anew at each step and grows where nothing grows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .balls import flint, identity, matrix, midpoint
from .spline_in_balls import cubics
from .taylor_steps import parts, shifted, step

MOST_STEPS = 50_000
EXACT = 4400  # bits in which a sum of two doubles has no error


class TooLong(ValueError):
    """More steps than are taken."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Doubles A (nt, n, n) at times t (nt,) [s]; the spline through them is taken until `until` [s] after t[0]."""

    t: np.ndarray
    A: np.ndarray
    until: float | None = None  # None: the last node


class Frames:
    """A product of balls, kept as Q R."""

    def __init__(self, n: int) -> None:
        self.Q, self.R = identity(n), identity(n)

    def times(self, P: Any) -> None:
        """P from the left."""
        moved = P * self.Q
        centre = midpoint(moved)
        if not np.isfinite(centre).all():
            raise TooLong("the transition matrix leaves the range of numbers")
        self.Q = matrix(np.linalg.qr(centre)[0])
        self.R = self.Q.solve(moved) * self.R

    @property
    def whole(self) -> Any:
        return self.Q * self.R


def intervals(piece: Piece) -> Iterator[tuple[float, list[list[Any]], Any]]:
    """For each interval its end [s], the cubics of its steps and how long each is."""
    arb = flint().arb
    n = piece.A.shape[-1]
    flat = piece.A.reshape(len(piece.t), -1)
    moving = np.flatnonzero((flat != flat[0]).any(axis=0))
    still = flat[0].copy()
    still[moving] = 0.0
    base, zero = matrix(still.reshape(n, n)), matrix(np.zeros((n, n)))
    found = cubics(piece.t, flat[:, moving]) if len(moving) else [()] * (len(piece.t) - 1)
    with flint().ctx.workprec(EXACT):
        end = None if piece.until is None else arb(float(piece.t[0])) + arb(piece.until)
    for k, rows in enumerate(found):
        begin, last = arb(float(piece.t[k])), arb(float(piece.t[k + 1]))
        if end is not None:
            if not begin < end:
                return
            if not last < end or k == len(found) - 1:
                last = end
        A = [base, zero, zero, zero]
        for power, row in enumerate(rows):
            entries = A[power].entries()
            for j, value in zip(moving, row.entries()):
                entries[j] = value
            A[power] = flint().arb_mat(n, n, entries)
        yield float(last.mid()), *_cut(A, last - begin)


def _cut(A: list[Any], h: Any) -> tuple[list[list[Any]], Any]:
    count = parts(A, h)
    if count > MOST_STEPS:
        raise TooLong(f"an interval needs {count:,} steps, more than {MOST_STEPS:,}: leave out the fastest modes")
    length = h / count
    return [A if j == 0 else shifted(A, length * j) for j in range(count)], length


def transitions(pieces: Sequence[Piece], jumps: Sequence[np.ndarray]) -> Iterator[tuple[float, list[Any], list[Any]]]:
    """For each interval of the pieces in turn its end [s], the jump before it if there is one, and the enclosed steps
    over it.
    """
    steps = 0
    for k, piece in enumerate(pieces):
        first = [matrix(jumps[k - 1])] if k else []
        for t, cut, length in intervals(piece):
            steps += len(cut)
            if steps > MOST_STEPS:
                raise TooLong(f"more than {MOST_STEPS:,} steps are needed: leave out the fastest modes")
            yield t, first, [step(A, length) for A in cut]
            first = []
    if len(jumps) == len(pieces):  # one more after the last, as between two periods
        yield float(pieces[-1].t[-1]), [matrix(jumps[-1])], []

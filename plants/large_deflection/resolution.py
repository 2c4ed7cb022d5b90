"""How many quadrature points the shapes of a beam need: every kind of shape is asked, not one count for all.

A rule of m points knows the shapes at its points only. Its error is judged by their inertia G = int psi psi^T, or that
of the axis they move, int (int psi)(int psi)^T: the largest relative error of any combination of the shapes is the
largest |eigenvalue - 1| of (G by the rule, G by the finest rule). Half of it is that of a frequency.

Source   Rayleigh's quotient: with K exact, omega^2 = q.K q/q.G q errs as G does
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from pliant.plants.exact_rotations.quadrature import Array, Points, points

FINEST = 64  # points of the rule that others are judged by: exact to rounding for all shapes that a plant may have
REFUSED = 0.1  # of a shape's inertia: points with a larger error are too few


class Resolved(NamedTuple):
    """Shapes (k,) -> (k, n) that the points must resolve."""

    name: str
    shapes: Callable[[Array], Array]
    moves: bool  # whether the axis moves at the integral of the shapes, or sections turn by them
    within: float  # error that the default keeps

    def error(self, at: Points) -> float:
        """Largest relative error of the inertia of any combination of the shapes."""
        rule, exact = (self._rows(p) for p in (at, points(FINEST)))
        if not exact.shape[1]:
            return 0.0
        weight = np.asarray(np.linalg.qr(exact, mode="r"))
        inner = np.linalg.solve(weight.T, rule.T)
        return float(np.abs(np.linalg.eigvalsh(inner @ inner.T) - 1).max())

    def _rows(self, at: Points) -> Array:
        """Rows whose Gram matrix is the inertia."""
        psi = self.shapes(at.xi)
        return at.root @ psi if self.moves else np.sqrt(at.weight)[:, None] * psi


def enough(kinds: Sequence[Resolved], first: int) -> int:
    """The fewest points, from `first` on, that keep every kind's error."""
    for m in range(min(first, FINEST), FINEST):
        if all(kind.error(points(m)) <= kind.within for kind in kinds):
            return m
    return FINEST


def check_given(owner: str, given: int, kinds: Sequence[Resolved], first: int) -> None:
    """ValueError where the points given take the inertia of some shape wrong by more than REFUSED."""
    for kind in kinds:
        error = kind.error(points(given))
        if error > REFUSED:
            raise ValueError(
                f"{owner}.points = {given} are too few for {kind.name}: the inertia of a shape errs by {error:.2g} "
                f"of itself (<= {REFUSED}); None takes {enough(kinds, first)}"
            )

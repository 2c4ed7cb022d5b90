"""Quadrature of a beam whose root moves: the root's position stands before the tangents as one more of them.

r(xi)/L = r_0/L + sum_b t_b int_0^xi l_b, so that with t_0 = r_0/L the kinetic energy is (1/2) rho A L^3 sum W_ab
t_a' . t_b' again, W_00 = 1 and W_0b = int int_0^xi l_b; the tip and the mean position are weighted sums as before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .quadrature import Array, Points


@dataclass(frozen=True, eq=False)
class RootedPoints(Points):
    """The root, then the points of `along`."""

    along: Points

    @classmethod
    def of(cls, along: Points) -> RootedPoints:
        """The points of a beam with a resting root, and the root."""
        mean = along.first_moment
        W = np.block([[np.ones((1, 1)), mean[None]], [mean[:, None], along.root.T @ along.root]])
        root = np.linalg.cholesky(W[::-1, ::-1]).T[::-1, ::-1]
        return cls(np.append(0.0, along.xi), np.append(1.0, along.weight), root, along.panels, along)

    def cumulative(self, xi: Array) -> Array:
        """What makes positions at xi (k,) of the root's position and the tangents, (k, 1 + m)."""
        return np.column_stack([np.ones(len(np.atleast_1d(xi))), self.along.cumulative(xi)])

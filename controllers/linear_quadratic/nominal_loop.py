"""A nominal as a regulator along it sees it: what the loop itself makes of it, and how far along it a state is."""

from __future__ import annotations

from typing import final

import numpy as np

from pliant.controllers.riccati.time_varying import TimeVaryingRegulator
from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray
AHEAD = 8  # nodes that are looked at


def own_nominal(
    regulator: TimeVaryingRegulator, A: Array, B: Array, c: Array, x: Array, u: Array
) -> tuple[Array, Array]:
    """x* (T+1, nx) and u* (T+1, nu), its last row as given: the linear loop from the start of the nominal x, u.

    e+ = A e + B du + c,  du = -K e - k: where the nominal is a motion of the plant, c = 0 and k = 0, they are x and u.
    """
    e, fed = np.zeros_like(x), np.vstack([u, u[-1:]])
    for k in range(len(u)):
        du = -regulator.K[k] @ e[k] - regulator.k[k]
        fed[k] += du
        e[k + 1] = A[k] @ e[k] + B[k] @ du + c[k]
    return x + e, fed


@final
class PathProgress(OwnsArrays):
    """The nearest of the next nodes of x (T+1, nx), distances in `scale` (nx,); it moves on by `slowest` to `fastest`
    nodes a call."""

    def __init__(self, x: Array, scale: Array, slowest: float, fastest: float) -> None:
        if not 0 < slowest <= 1 <= fastest < AHEAD:
            raise ValueError(
                f"TVLQR.slowest, fastest = {slowest}, {fastest} must be 0 < slowest <= 1 <= fastest < {AHEAD}"
            )
        self._scale, self._last, self._slowest, self._fastest = scale, len(x) - 1, slowest, fastest
        self._path = np.vstack([x, np.repeat(x[-1:], AHEAD, axis=0)]) * scale
        self.reset()

    def reset(self) -> None:
        """Back to the start."""
        self.phase = 0.0  # nodes

    def node(self, y: Array) -> int:
        """The node for the state y (nx,); the phase moves on for the next call."""
        first = int(self.phase)
        if first >= self._last:
            return self._last
        away = self._path[first : first + AHEAD] - y * self._scale
        nearest = first + int(np.einsum("ij,ij->i", away, away).argmin())
        k = min(nearest, int(self.phase + self._fastest))
        self.phase = max(float(k), self.phase + self._slowest)
        return min(k, self._last)

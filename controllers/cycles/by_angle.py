"""Values at the nodes of a cycle, and between them by the angle that goes round."""

from __future__ import annotations

from typing import final

import numpy as np

from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray


@final
class ByAngle(OwnsArrays):
    """Nodes by their angle within one turn: `order` (N,) brings values by time into the order of the angle."""

    def __init__(self, angle: Array) -> None:
        """angle (N,) [rad] of the nodes, by time."""
        within = np.mod(angle, 2 * np.pi)
        self.order = np.argsort(within, kind="stable")
        self.phi = within[self.order]
        self._ends = np.r_[self.phi[-1] - 2 * np.pi, self.phi, self.phi[0] + 2 * np.pi]

    def around(self, values: Array) -> Array:
        """Values by angle (N, ..) with the last before the first, and the first after the last: (N + 2, ..)."""
        return values[np.r_[-1, np.arange(len(self.phi)), 0]]

    def at(self, angle: float) -> tuple[int, float]:
        """k, s: values there are (1 - s) v[k] + s v[k + 1] of what `around` gave."""
        phi, ends = angle % (2 * np.pi), self._ends
        k = min(max(int(np.searchsorted(ends, phi, side="right")) - 1, 0), len(ends) - 2)
        return k, float((phi - ends[k]) / (ends[k + 1] - ends[k]))

    def nearest(self, angle: float) -> int:
        """The node, by time."""
        k, share = self.at(angle)
        return int(self.order[(k - 1 + (share > 0.5)) % len(self.phi)])

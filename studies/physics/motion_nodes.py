"""The nodes at which a motion under held inputs is corrected: two Gauss points in each part of a control period.

Inputs jump from one period to the next, and so do accelerations: no interpolation reaches across them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pliant.plants.core.signals import GAUSS

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class MotionNodes:
    """Control times (nt,) [s], each period cut into `parts`; u (nt, nu) is held from each time to the next."""

    times: Array
    held: Array
    parts: int

    @cached_property
    def h(self) -> Array:
        """Length of each part (m,) [s]."""
        return np.repeat(np.diff(self.times) / self.parts, self.parts)

    @cached_property
    def all(self) -> Array:
        """Every part's beginning and two Gauss points, and the end, (3 m + 1,) [s]."""
        share = np.arange(self.parts) / self.parts
        begin = (self.times[:-1, None] + np.diff(self.times)[:, None] * share).ravel()
        inner = begin[:, None] + self.h[:, None] * GAUSS
        return np.append(np.column_stack([begin, inner]).ravel(), self.times[-1])

    @cached_property
    def inputs(self) -> Array:
        """The input held from each of all these times on, (3 m + 1, nu)."""
        return np.vstack([np.repeat(self.held[:-1], 3 * self.parts, axis=0), self.held[-1:]])

    @cached_property
    def gauss(self) -> Array:
        """Which of all times are Gauss points, (2 m,)."""
        k = np.arange(len(self.all) - 1)
        return k[k % 3 != 0]

    @cached_property
    def ends(self) -> Array:
        """Which are ends of parts, (m + 1,)."""
        return np.arange(0, len(self.all), 3)

    @cached_property
    def control(self) -> Array:
        """Which of the ends are control times, (nt,)."""
        return np.arange(0, len(self.ends), self.parts)

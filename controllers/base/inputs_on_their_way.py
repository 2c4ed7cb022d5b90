"""Inputs that were asked for and do not act yet, the oldest first."""

from __future__ import annotations

from typing import final

import numpy as np

from pliant.plants.core.signals import OwnsArrays


@final
class OnTheirWay(OwnsArrays):
    """`values` (M nu,), overwritten by `push`: the oldest leaves, the newest (nu,) comes last."""

    def __init__(self, first: np.ndarray, nu: int) -> None:
        """first (M nu,): what is on its way at the start."""
        self.first, self.nu = first, nu
        self.reset()

    def reset(self) -> None:
        """As at the start."""
        self.values = np.array(self.first, dtype=float)

    def push(self, u: np.ndarray) -> None:
        """u (nu,) was asked for."""
        if len(self.values):
            self.values[: -self.nu] = self.values[self.nu :].copy()
            self.values[-self.nu :] = u

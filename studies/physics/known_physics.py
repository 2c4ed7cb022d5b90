"""What is known of physics' motion: its compared outputs and their error by cause, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants import Plant
from pliant.plants.validity.ranges import in_words
from pliant.plants.validity.rotating_sections import NONE_HOLDS

from .quasi_linear import CorrectedMotion

Array = np.ndarray
KNOWN = 0.03  # of the tolerance: to what each of the three errors is brought, and ..
ROUNDING = 1e-7  # .. of the outputs themselves: no better is asked


@dataclass(frozen=True, eq=False)
class PhysicsMotion:
    """The compared outputs (nt, n) at the control times, and their error by cause [their unit]."""

    outputs: Array
    physics: Plant
    passes: float
    time: float
    shapes: float
    how: str  # in words
    estimated: dict[str, float] = field(default_factory=dict)  # {effect that it leaves out: about what it is worth}
    left: tuple[dict[str, Any], ...] = ()  # its own ranges that it leaves, each as in Trajectory.stats["validity"]
    motion: CorrectedMotion | None = field(default=None, repr=False)  # None where it was simulated

    @property
    def uncertainty(self) -> float:
        """The sum of the errors told, and of what is estimated of effects that it leaves out; what `physics.unmodelled`
        names beside is no part of it.
        """
        return self.passes + self.time + self.shapes + sum(self.estimated.values())

    @property
    def outside(self) -> str:
        """Ranges that it leaves beyond which other kinematics would hold, in words: it is then no physics."""
        return "; ".join(in_words(entry) for entry in self.left if entry["holds"] != NONE_HOLDS)

    @property
    def beyond(self) -> tuple[str, ...]:
        """Those beyond which no kinematics of this library hold, in words: materials that are no longer linear."""
        return tuple(in_words(entry) for entry in self.left if entry["holds"] == NONE_HOLDS)


def largest(difference: Array) -> float:
    """Its largest magnitude."""
    return float(np.abs(difference).max())

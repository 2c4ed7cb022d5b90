"""What a predictive controller says about its own acts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.signals import OwnsArrays


@dataclass
class Record(OwnsArrays):
    """Counts since `reset`. Violations are predicted ones, of limits that may be exceeded at a price."""

    names: tuple[str, ...] = ()  # of the soft limits
    calls: int = 0
    limited: int = 0  # acts that a limit changed
    failures: int = 0  # acts without a solution: the last plan went on, past its end the unlimited law within limits
    violations: int = 0  # acts whose prediction exceeds a soft limit
    unreached: int = 0  # acts whose tracked signals the limits keep from their values
    worst: np.ndarray = field(init=False)  # (len(names),) largest excess over the horizon of any act [its unit]

    def __post_init__(self) -> None:
        self.worst = np.zeros(len(self.names))

    def clear(self) -> None:
        """As new."""
        self.calls = self.limited = self.failures = self.violations = self.unreached = 0
        self.worst[:] = 0.0

    def violate(self, excess: np.ndarray) -> None:
        """Note the excess (len(names),) of one act."""
        self.violations += 1
        np.maximum(self.worst, excess, out=self.worst)

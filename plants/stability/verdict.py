"""The verdict on a model's stability: the answer, and what each method said of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

METHODS = ("eigenvalues", "floquet", "slow_variation", "lyapunov", "growth", "frozen_time")
GROWTH = ("decays", "bounded", "polynomial", "exponential", "unknown")


@dataclass(frozen=True, eq=False)
class Verdict:
    """The answer, the method that gave it, and what every other method said or why it was not used."""

    verdict: str  # stable | unstable | marginal | undecided
    method: str  # the deciding method, "" where undecided
    margin: float  # decay rate [1/s] of the slowest deviation; below zero: growth. An estimate
    critical_times: tuple[float, ...]  # [s] where frozen roots cross the axis, or windows begin or cease to grow
    why: str
    reasons: Mapping[str, str]  # of every method but the deciding one
    evidence: Mapping[str, Any] = field(repr=False)  # the results by method
    coordinates: str = ""  # in which the frozen-time roots were taken
    margin_bound: float = (
        np.nan
    )  # [1/s] guaranteed: nothing that the data allow decays slower (grows faster); NaN: none
    growth: str = "unknown"  # of GROWTH: how the deviation that lasts longest behaves

    @property
    def stable(self) -> bool:
        return self.verdict == "stable"

    def rows(self) -> list[tuple[str, str, str]]:
        """Method, role ("decides", "beside", "not used") and words: the verdict's table."""
        found = []
        for name in METHODS:
            role = "decides" if name == self.method else "beside" if name in self.evidence else "not used"
            found.append((name, role, self.why if name == self.method else self.reasons.get(name, "")))
        return found

    def __str__(self) -> str:
        head = f"{self.verdict} by {self.method}" if self.method else self.verdict
        lines = [f"{head}: {self.why}", *(f"  {name}, {role}: {text}" for name, role, text in self.rows())]
        if self.critical_times:
            lines.append("  critical times [s]: " + ", ".join(f"{t:.4g}" for t in self.critical_times[:12]))
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        return {
            "verdict": self.verdict,
            "method": self.method,
            "margin": self.margin if np.isfinite(self.margin) else None,
            "margin_bound": self.margin_bound if np.isfinite(self.margin_bound) else None,
            "growth": self.growth,
            "critical_times": list(self.critical_times),
            "why": self.why,
            "reasons": dict(self.reasons),
            "coordinates": self.coordinates,
        }

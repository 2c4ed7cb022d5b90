"""The answer about the long run: intervals of rates, the verdict that follows, and what was taken for granted."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.signals import OwnsArrays

from .transient import Transient

FELT = 0.1  # of the largest component: a state with less is not named
ZERO = 1e-9  # of |A|: a rate this small is none


@dataclass(frozen=True)
class Drift:
    """An interval around zero: what moves there neither decays nor grows, as far as is known."""

    low: float  # [1/s]
    high: float  # [1/s]
    states: tuple[str, ...]  # that take part, the largest first


@dataclass(frozen=True, eq=False)
class Spectrum(OwnsArrays):
    """Intervals belong to groups of directions, the fastest first."""

    verdict: str  # stable | unstable | drift
    exponents: np.ndarray  # (n,) [1/s] largest first: averages over the record, or exact where `assumption` gives them
    intervals: np.ndarray  # (m, 2) [1/s] lowest and highest rate of each group
    groups: tuple[tuple[int, ...], ...]  # (m) which exponents each holds
    gaps: np.ndarray  # (m - 1,) [1/s] least difference of the averages of neighbouring groups: > 0 where separated
    drift: tuple[Drift, ...]
    directions: np.ndarray = field(repr=False)  # (n, n): columns are directions in which a group moves, at the end
    averages: np.ndarray = field(repr=False)  # (n, 2) [1/s] least and largest running average after `settle`
    regular: bool  # whether running averages come to rest as far as the record shows
    transient: Transient
    assumption: str  # what is taken for granted beyond the record
    window: float  # [s] of the averages; NaN where none were taken
    states: tuple[str, ...]

    @property
    def why(self) -> str:
        """One sentence for a report."""
        top = self.intervals[0] if len(self.intervals) else np.zeros(2)
        if self.verdict == "unstable":
            text = f"some deviation grows at {top[0]:.4g} to {top[1]:.4g} 1/s"
        elif self.verdict == "stable":
            text = f"every deviation decays in the long run, the slowest at {-top[1]:.4g} 1/s or faster"
        else:
            parts = (f"{', '.join(d.states)} at {d.low:.3g} to {d.high:.3g} 1/s" for d in self.drift)
            text = f"drift is not to be told from decay or growth: {'; '.join(parts)}"
        if not self.regular:
            text += "; running averages do not come to rest, no limit is shown (not regular where none is)"
        if self.transient.factor > 10:
            text += (
                f"; before that deviations grow up to {self.transient.factor:.3g}-fold, at {self.transient.time:.4g} s"
            )
        return f"{text}, provided that {self.assumption}"

    def __str__(self) -> str:
        return f"{self.verdict}: {self.why}"


def from_intervals(
    names: tuple[str, ...],
    rates: np.ndarray,
    intervals: np.ndarray,
    groups: tuple[tuple[int, ...], ...],
    gaps: np.ndarray,
    V: np.ndarray,
    averages: np.ndarray,
    regular: bool,
    before: Transient,
    assumption: str,
    window: float,
) -> Spectrum:
    """The verdict, and the states of what drifts, from intervals (m, 2) and directions V (n, n)."""
    size = np.linalg.norm(V, axis=0)
    V = V / np.where(size > 0, size, 1.0)
    zero = ZERO * max(float(np.abs(intervals[np.isfinite(intervals)]).max(initial=0.0)), 1e-300)
    drift = []
    for (low, high), group in zip(intervals, groups):
        if low <= zero and high >= -zero:
            weight = np.linalg.norm(V[:, list(group)], axis=1)
            order = np.argsort(-weight, kind="stable")
            named = tuple(names[k] for k in order if weight[k] > FELT * weight.max(initial=0.0))
            drift.append(Drift(float(low), float(high), named))
    if len(intervals) and intervals[:, 0].max() > zero:
        verdict = "unstable"
    else:
        verdict = "drift" if drift else "stable"
    about = (averages, regular, before, assumption, window, names)
    return Spectrum(verdict, rates, intervals, groups, gaps, tuple(drift), V, *about)

"""What a fit leaves of the errors e of its samples: r = (I - H) e, H the projection on the sensitivities.

Errors are in standard deviations of their sensors, in one row (N,): motion by motion, sensor by sensor, by time,
without missing samples. Unknown starts belong to one motion each, so H is kept as a basis of theirs in every motion and
one of the parameters, which those of the starts are taken out of: no array has more than N times (starts of a motion +
np) entries.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.experiments.experiment import Checked

from .fisher_information import DEPENDENT
from .output_error import Played

Array = np.ndarray


@dataclass(frozen=True)
class Series:
    """The samples [first, end) of the row that one sensor read in one motion."""

    signal: str
    motion: int
    first: int
    end: int


@dataclass(frozen=True, eq=False)
class ResidualSpace:
    """(I - H), and the samples it belongs to."""

    series: tuple[Series, ...]
    t: Array  # (N,) [s]
    computed: Array  # (N,) what the plant's sensors read, in standard deviations
    residual: Array  # (N,) in standard deviations
    of_starts: tuple[tuple[int, int, Array], ...]  # of each motion (first, end, basis (end - first, starts))
    of_parameters: Array  # (N, np) basis

    @classmethod
    def of(
        cls, experiments: Sequence[Checked], played: Sequence[Played], sigma: Mapping[str, float], free: Array
    ) -> ResidualSpace:
        """Of motions at the end of a fit; `free` (np,): parameters that do not stand at a bound."""
        series, times, computed, left = [], [], [], []
        of_starts, slopes, end = [], [], 0
        for k, (one, this) in enumerate(zip(experiments, played)):
            begin, rows = end, []
            for j, name in enumerate(one.signals):
                known = ~np.isnan(this.residual[:, j])
                first, end = end, end + int(known.sum())
                series.append(Series(name, k, first, end))
                times.append(one.t[known])
                left.append(this.residual[known, j] / sigma[name])
                computed.append((one.y[known, j] - this.residual[known, j]) / sigma[name])
                rows.append(this.slopes[known, j] / sigma[name])
            J = np.vstack(rows)
            starts, J = basis(J[:, len(free) :]), J[:, : len(free)][:, free]
            rest = J - starts @ (starts.T @ J)
            told = np.linalg.norm(rest, axis=0) > DEPENDENT * np.linalg.norm(J, axis=0)
            of_starts.append((begin, end, starts))
            slopes.append(np.where(told, rest, 0.0))
        t, y, r = (np.concatenate(v) for v in (times, computed, left))
        return cls(tuple(series), t, y, r, tuple(of_starts), basis(np.vstack(slopes)))

    def left(self, e: Array) -> Array:
        """(I - H) e of errors (.., N)."""
        rest = np.array(e, dtype=float)
        for first, end, Q in self.of_starts:
            rest[..., first:end] -= (rest[..., first:end] @ Q) @ Q.T
        return rest - (rest @ self.of_parameters) @ self.of_parameters.T

    def freedom(self, signal: str) -> float:
        """Degrees of freedom that are left to a sensor's residuals: the trace of its part of I - H."""
        taken = (self.of_parameters**2).sum(axis=1)
        for first, end, Q in self.of_starts:
            taken[first:end] += (Q**2).sum(axis=1)
        return float(sum((1 - taken[one.first : one.end]).sum() for one in self.of_signal(signal)))

    def of_signal(self, signal: str) -> list[Series]:
        """The series of one sensor that hold a sample."""
        return [one for one in self.series if one.signal == signal and one.end > one.first]


def basis(J: Array) -> Array:
    """An orthonormal basis (N, rank) of the columns (N, n), which are judged by their directions alone."""
    size = np.linalg.norm(J, axis=0)
    if not size.any():
        return np.zeros((len(J), 0))
    Q, R = np.linalg.qr(J[:, size > 0] / size[size > 0])
    U, s, _ = np.linalg.svd(R, full_matrices=False)
    found: Array = Q @ U[:, s > DEPENDENT * s[0]]
    return found

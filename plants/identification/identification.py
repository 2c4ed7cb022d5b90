"""What an identification found: values, how sure they are, what cannot be told, what speaks against believing it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.dynamics.plant import Plant

from .fisher_information import NORMAL, Untold, covariance, untold
from .output_error import Fit, OutputError, Played

Array = np.ndarray
Interval = tuple[float, float]
COLUMNS = ("parameter", "value", "standard error", "95 % interval", "unit")
NOTHING: Interval = (-math.inf, math.inf)


@dataclass(frozen=True, eq=False)
class Residuals(OwnsArrays):
    """Measured less computed outputs of one motion, in the signals' units; NaN where a sample is missing."""

    name: str
    t: Array  # (nt,) [s]
    signals: tuple[str, ...]
    values: Array  # (nt, ny)


@dataclass(frozen=True, eq=False, repr=False)
class Identification(OwnsArrays):
    """Estimates of a plant's parameters from measured motions.

    values, standard_errors  {parameter: number} in `units`. The errors are what the Fisher information gives if the
                             residuals are white noise of the sizes `noise`; `doubts` says what speaks against that
    intervals                {parameter: (low, high)} of 95 %; (-inf, inf) where none is claimed: of every parameter
                             where there are doubts, and of those in `unidentifiable` or at a bound
    unidentifiable           parameters and groups of them that these data cannot tell
    correlation              (np, np) of the estimates; NaN where one has no variance
    noise                    {signal: standard deviation}, given or estimated
    starts                   of each motion {state: (value, standard error)} of the states that were not known
    step_error               largest change of a value, in its standard errors, that steps half as long would make
    """

    given: Plant
    values: Mapping[str, float]
    units: Mapping[str, str]
    standard_errors: Mapping[str, float]
    intervals: Mapping[str, Interval]
    unidentifiable: tuple[Untold, ...]
    doubts: tuple[str, ...]
    correlation: Array
    noise: Mapping[str, float]
    noise_given: tuple[str, ...]
    starts: tuple[Mapping[str, tuple[float, float]], ...]
    residuals: tuple[Residuals, ...]
    at_bound: tuple[str, ...]
    converged: bool
    step_error: float
    samples: int
    stats: Mapping[str, Any] = field(default_factory=dict)

    @property
    def trusted(self) -> bool:
        """Whether nothing speaks against the noise model on which errors and intervals rest."""
        return not self.doubts

    @property
    def plant(self) -> Plant:
        """The plant with the values found in place of its own, none varied.

        Shape functions that are computed from a parameter, as those of basis="payload", are then those of the value
        found; the motions were computed with those of the plant given.
        """
        made = dataclasses.replace(self.given, varied=())
        for path, value in self.values.items():
            made = parameters.put(made, path, value)
        return made

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on what limits the result: doubts, what cannot be told, parameters at a bound."""
        bound = [f"{n} stands at a bound of its search; no interval is claimed for it" for n in self.at_bound]
        return (*self.doubts, *(group.words for group in self.unidentifiable), *bound)

    def rows(self) -> list[tuple[str, ...]]:
        """A row a parameter, as text under COLUMNS."""
        found: list[tuple[str, ...]] = []
        for name, value in self.values.items():
            low, high = self.intervals[name]
            span = f"{low:.6g} to {high:.6g}" if math.isfinite(high - low) else "none claimed"
            found.append((name, f"{value:.6g}", f"{self.standard_errors[name]:.3g}", span, self.units[name]))
        return found

    def summary(self) -> str:
        """The result as text, a line a parameter."""
        rows = [COLUMNS, *self.rows()]
        widths = [max(map(len, column)) for column in zip(*rows)]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
        levels = [
            f"{name} {level:.3g} ({'given' if name in self.noise_given else 'estimated'})"
            for name, level in self.noise.items()
        ]
        lines.append(f"noise: {', '.join(levels)}; {self.samples} samples of {len(self.residuals)} motions")
        return "\n".join([*lines, *self.remarks])

    def table(self) -> dict[str, Any]:
        """The result as plain numbers and words, for JSON; what is infinite or no number is None."""
        rows = {
            name: {
                "value": value,
                "unit": self.units[name],
                "standard_error": _plain(self.standard_errors[name]),
                "interval": [_plain(end) for end in self.intervals[name]],
            }
            for name, value in self.values.items()
        }
        return {
            "parameters": rows,
            "unidentifiable": [
                {
                    "names": list(g.names),
                    "direction": list(g.direction),
                    "standard_deviation": _plain(g.standard_deviation),
                }
                for g in self.unidentifiable
            ],
            "doubts": list(self.doubts),
            "at_bound": list(self.at_bound),
            "correlation": [[_plain(v) for v in row] for row in self.correlation.tolist()],
            "noise": {n: {"value": v, "given": n in self.noise_given} for n, v in self.noise.items()},
            "starts": [{s: [_plain(v) for v in pair] for s, pair in one.items()} for one in self.starts],
            "converged": self.converged,
            "step_error": _plain(self.step_error),
            "samples": self.samples,
            **self.stats,
        }

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.6g}" for name, value in self.values.items())
        return f"Identification({values}{'' if self.trusted else ', not to be trusted'})"


def conclude(
    problem: OutputError,
    fit: Fit,
    played: Sequence[Played],
    given_noise: Mapping[str, float],
    doubts: tuple[str, ...],
    step_error: float,
    stats: Mapping[str, Any],
) -> Identification:
    """The result of a search's end, with intervals where they may be claimed."""
    space, theta = problem.space, problem.parameters(fit.z)
    R = problem.information(played, fit.sigma)
    C = covariance(R) * np.outer(space.scale, space.scale)
    deviation = np.sqrt(np.diag(C))
    relative = np.where(theta != 0, np.abs(theta), space.scale) / space.scale
    groups, bound = untold(R * relative, space.names), tuple(space.at_bound(theta))
    lost = {name for g in groups for name in g.names} | set(bound)
    all_given = set(given_noise) == set(problem.signals)
    width = (NORMAL if all_given else _student(problem.samples - len(fit.z))) * deviation
    intervals = {
        name: NOTHING if doubts or name in lost else (float(v - w), float(v + w))
        for name, v, w in zip(space.names, theta, width)
    }
    sizes = np.where(np.isfinite(deviation) & (deviation > 0), deviation, np.nan)
    return Identification(
        given=problem.plant,
        values=dict(zip(space.names, theta.tolist())),
        units=dict(zip(space.names, space.units)),
        standard_errors=dict(zip(space.names, deviation.tolist())),
        intervals=intervals,
        unidentifiable=groups,
        doubts=doubts,
        correlation=C / np.outer(sizes, sizes),
        noise=dict(fit.sigma),
        noise_given=tuple(given_noise),
        starts=tuple(_starts(problem, fit)),
        residuals=tuple(Residuals(e.name, e.t, e.signals, one.residual) for e, one in zip(problem.experiments, played)),
        at_bound=bound,
        converged=fit.converged,
        step_error=step_error,
        samples=problem.samples,
        stats=stats,
    )


def _starts(problem: OutputError, fit: Fit) -> Iterator[dict[str, tuple[float, float]]]:
    """Of each motion {state: (value, standard error)} of the unknown ones."""
    errors = np.sqrt(np.diag(covariance(fit.at.R)))
    for k, one in enumerate(problem.experiments):
        x0, own = problem.starts(fit.z, k), errors[problem.ends[k] : problem.ends[k + 1]] * one.scale
        yield {problem.plant.states[i].name: (float(x0[i]), float(e)) for i, e in zip(one.unknown, own)}


def _student(freedom: int) -> float:
    """Student's quantile of 97.5 %: where noise is estimated."""
    from scipy.stats import t

    return float(t.ppf(0.975, max(1, freedom)))


def _plain(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None

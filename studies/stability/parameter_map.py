"""A chart of stability over two parameters: one verdict per point of a grid, in parallel through joblib.

The same call runs on this machine or on a cluster: `backend` is joblib's. "loky" and "threading" need nothing, "dask"
(pip install pliant[dask]) uses the dask.distributed client that is open, "ray" (pip install pliant[ray]) the cluster
that is initialised, or a local one.
"""

from __future__ import annotations

import json
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants import Plant, Trajectory
from pliant.plants.core.argument_gates import (
    require_by_name,
    require_choice,
    require_finite,
    require_function,
    require_instance,
    require_mapping,
    require_path,
    require_seconds,
)
from pliant.plants.core.errors import unstable_rests_untold
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.files.atomic_files import Together
from pliant.plants.stability import assess
from pliant.studies.common import machine
from pliant.studies.common.parallel import BACKENDS, as_they_come
from pliant.studies.common.reference_motions import Progress, silent
from pliant.studies.fidelity.mode_count import ModeCount, ModesNeeded, modes_needed
from pliant.studies.figures import style
from pliant.studies.figures.stability import chart

__all__ = ["ModeCount", "ModesNeeded", "StabilityMap", "map_stability", "modes_needed"]

KINDS = ("stable", "bounded", "drift", "marginal", "undecided", "unstable", "failed")
TASKS = 64  # portions that the grid is cut into, where it has that many points

Builder = Callable[..., Any]  # build(first, second) -> LinearModel, LTVModel or PiecewiseLTV


@dataclass(frozen=True, eq=False)
class StabilityMap(OwnsArrays):
    """Row i belongs to values[0][i] of the first parameter, column j to values[1][j] of the second."""

    names: tuple[str, str]
    values: tuple[np.ndarray, np.ndarray]
    verdicts: np.ndarray = field(repr=False)  # (n0, n1) words of KINDS
    margins: np.ndarray = field(repr=False)  # (n0, n1) decay rate [1/s] of the slowest deviation; NaN where it failed
    margin_bounds: np.ndarray = field(repr=False)  # (n0, n1) [1/s] guaranteed, see Verdict.margin_bound; NaN where none
    methods: np.ndarray = field(repr=False)  # (n0, n1) the deciding method
    failures: Mapping[tuple[int, int], str]  # why a point has no verdict
    seconds: float  # wall time
    backend: str

    def share(self, verdict: str) -> float:
        """The share of the points with this verdict."""
        require_choice("StabilityMap.share", "verdict", verdict, KINDS)
        return float(np.mean(self.verdicts == verdict))

    def to_json(self) -> dict[str, Any]:
        margins = [[m if np.isfinite(m) else None for m in row] for row in self.margins.tolist()]
        return {
            "names": list(self.names),
            "values": [v.tolist() for v in self.values],
            "verdicts": self.verdicts.tolist(),
            "margins": margins,
            "margin_bounds": [[m if np.isfinite(m) else None for m in row] for row in self.margin_bounds.tolist()],
            "methods": self.methods.tolist(),
            "failures": [{"at": list(at), "why": why} for at, why in self.failures.items()],
            "seconds": self.seconds,
            "backend": self.backend,
        }

    def save(self, table: str | Path | None = None, picture: str | Path | None = None, **options: Any) -> None:
        """Write the table as json and the picture as its ending says; options as in `figures.stability.chart`.

        Both take their places at once when both are finished. OSError, which names the file.
        """
        with Together() as files:
            if table is not None:
                files.text(require_path("StabilityMap.save: table", table), json.dumps(self.to_json(), indent=1) + "\n")
            if picture is not None:
                style.save(chart(self, **options), picture, files)


def map_stability(
    plant: Plant | Builder,
    grid: Mapping[str, Any],
    *,
    nominal: Trajectory | None = None,
    at: Mapping[str, float] | None = None,
    period: float | None = None,
    jobs: int = -1,
    backend: str = "loky",
    progress: Progress | None = None,
    **options: Any,
) -> StabilityMap:
    """The verdict at each point of `grid`, {first name: values, second name: values}.

    `plant`: a function build(first, second) of two numbers that returns a model; or a Plant, whose parameters the grid
    names ("payload.mass"): it is linearised along `nominal`, the same at all points, or, where that is None, in the
    equilibrium of each point with the states `at` held. A point that cannot be built is "failed" with its reason.
    `period` and `options` as in `assess`. `jobs` and `backend` are joblib's; a cluster must be able to import what
    `plant` needs.
    """
    names, axes = _checked(grid)
    jobs = machine.processes("map_stability", jobs)
    if nominal is not None:
        require_instance("map_stability.nominal", nominal, Trajectory)
    period = None if period is None else require_seconds("map_stability.period", period)
    if progress is not None:
        require_function("map_stability.progress", progress)
    at = {} if at is None else require_by_name("map_stability.at", at)
    require_choice("map_stability", "backend", backend, BACKENDS)
    tell = silent if progress is None else progress
    build = _Point(plant, names, nominal, at) if isinstance(plant, Plant) else plant
    if not callable(build) or isinstance(build, type):
        raise ValueError(
            f"map_stability.plant is a {type(plant).__name__}, must be a Plant or a function of two numbers"
        )
    options = {"thorough": False, "period": period, **options}
    points = [(i, j) for i in range(len(axes[0])) for j in range(len(axes[1]))]
    portions = [points[k::TASKS] for k in range(min(TASKS, len(points)))]
    verdicts = np.full((len(axes[0]), len(axes[1])), "failed", dtype="<U9")
    methods, margins = np.full(verdicts.shape, "", dtype="<U16"), np.full(verdicts.shape, np.nan)
    bounds = margins.copy()
    failures: dict[tuple[int, int], str] = {}
    began, done = clock.perf_counter(), 0
    tell(0.0, f"{len(points)} points")
    tasks = [(build, axes, portion, options) for portion in portions]
    for results in as_they_come("map_stability", _portion, tasks, jobs, backend):
        for point, verdict, margin, bound, method, why in results:
            verdicts[point], margins[point], bounds[point], methods[point] = verdict, margin, bound, method
            if why:
                failures[point] = why
        done += len(results)
        tell(done / len(points), f"{done} of {len(points)} points")
    took = clock.perf_counter() - began
    return StabilityMap(names, axes, verdicts, margins, bounds, methods, dict(sorted(failures.items())), took, backend)


def _checked(grid: Mapping[str, Any]) -> tuple[tuple[str, str], tuple[np.ndarray, np.ndarray]]:
    grid = require_mapping("map_stability.grid", grid)
    if len(grid) != 2:
        raise ValueError(f"map_stability.grid = {sorted(grid)} must name two parameters")
    first, second = grid
    axes = tuple(require_finite(f"map_stability.grid[{name!r}]", grid[name], (-1,)) for name in (first, second))
    for name, axis in zip((first, second), axes):
        if len(axis) < 1 or (np.diff(axis) <= 0).any():
            raise ValueError(f"map_stability.grid[{name!r}] must be one or more ascending values")
    return (first, second), (axes[0], axes[1])


@dataclass(frozen=True)
class _Point:
    """A plant's model with two parameters as given: no rebuild per value."""

    plant: Plant
    names: tuple[str, str]
    nominal: Trajectory | None
    at: dict[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "plant", self.plant.vary(*self.names))

    def __call__(self, first: float, second: float) -> Any:
        p = np.array([first, second])
        if self.nominal is not None:
            return self.plant.linearize_along(self.nominal, p=p)
        with unstable_rests_untold():  # the map says so
            x0, u0 = self.plant.equilibrium(self.at, p=p)
        return self.plant.linearize(x0, u0, p=p)


def _portion(
    build: Builder, axes: tuple[np.ndarray, np.ndarray], points: Sequence[tuple[int, int]], options: dict[str, Any]
) -> list[tuple[tuple[int, int], str, float, float, str, str]]:
    found = []
    for i, j in points:
        try:
            verdict = assess(build(float(axes[0][i]), float(axes[1][j])), **options)
            found.append(((i, j), verdict.verdict, verdict.margin, verdict.margin_bound, verdict.method, ""))
        except Exception as failure:  # whatever a point raises is that point's failure, and no other's
            found.append(((i, j), "failed", np.nan, np.nan, "", f"{type(failure).__name__}: {failure}"))
    return found

"""Many runs of one controller, the plant's parameters drawn anew for each, in parallel and resumable.

The controller is designed once, on the scene's own plant, and meets plants that it was not designed for. What comes of
it: the failures, each with the parameters that it had, and the quantiles of what the runs that lasted were worth. Of n
runs without a failure the share that fails is below 1 - 0.05^(1/n) with 95 % confidence: 1.5 % for 200.
"""

from __future__ import annotations

import dataclasses
import pickle
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import betaincinv

from pliant.controllers import Controller
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import (
    require_choice,
    require_count,
    require_finite,
    require_flag,
    require_function,
    require_instance,
    require_mapping,
    require_number,
    require_path,
    shown,
)
from pliant.studies.common import machine
from pliant.studies.common.json_lines import add_line, read_lines
from pliant.studies.common.parallel import BACKENDS, as_they_come
from pliant.studies.common.reference_motions import Progress, silent

from .trial import MEASURED, Row, trial

QUANTILES = (0.05, 0.5, 0.95)
CONFIDENCE = 0.95


@dataclass(frozen=True, eq=False)
class MonteCarlo:
    """Rows by number: parameters, failure ("" where there was none), growth [1/s] of the linear loop, and the score."""

    rows: tuple[Row, ...]

    @property
    def failures(self) -> tuple[Row, ...]:
        """Runs that ended early."""
        return tuple(row for row in self.rows if row["failure"])

    @property
    def unstable(self) -> tuple[Row, ...]:
        """Runs whose linear loop grows, whether they lasted or not."""
        return tuple(row for row in self.rows if row["growth"] is not None and row["growth"] >= 0)

    def values(self, name: str) -> np.ndarray:
        """What was measured (k,) in the runs that have it: growth, cost, settling, peak, residual, at_limit, .."""
        require_choice("MonteCarlo.values", "name", name, MEASURED)
        return np.array([row[name] for row in self.rows if row[name] is not None], dtype=float)

    def quantiles(self, name: str, at: Sequence[float] = QUANTILES) -> tuple[float, ...]:
        """Of `values`, by order statistics that occurred; NaN where there is none."""
        shares = require_finite("MonteCarlo.quantiles: at", at, (-1,))
        if not ((shares >= 0) & (shares <= 1)).all():
            raise ValueError(f"MonteCarlo.quantiles: at = {shares.tolist()} must be >= 0 and <= 1")
        found = self.values(name)
        if not len(found):
            return (float("nan"),) * len(shares)
        return tuple(float(v) for v in np.quantile(found, shares, method="inverted_cdf"))

    @property
    def failing(self) -> tuple[float, float]:
        """The share that fails, and the largest that these runs leave possible with 95 % confidence (Clopper and
        Pearson's one-sided bound)."""
        n, k = len(self.rows), len(self.failures)
        return k / n, 1.0 if k == n else float(betaincinv(k + 1, n - k, CONFIDENCE))

    def __str__(self) -> str:
        share, most = self.failing
        lines = [f"{len(self.rows)} runs, {len(self.failures)} failed ({share:.3g}; below {most:.3g} with 95 %)"]
        if any(row["growth"] is not None for row in self.rows):
            lines[0] += f", the linear loop grows in {len(self.unstable)}"
        for name in MEASURED:
            if len(self.values(name)):
                low, middle, high = self.quantiles(name)
                lines.append(f"{name}: median {middle:.4g}, 5 % {low:.4g}, 95 % {high:.4g}")
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        named = {name: list(self.quantiles(name)) for name in MEASURED if len(self.values(name))}
        return {"runs": len(self.rows), "failures": len(self.failures), "quantiles": named, "rows": list(self.rows)}


def monte_carlo(
    scene: Scene,
    law: Controller | Callable[[Scene], Controller],
    ranges: Mapping[str, tuple[float, float]],
    *,
    runs: int = 200,
    seed: int = 0,
    noise: bool = False,
    delay: int = 0,
    jobs: int = 1,
    backend: str = "loky",
    kept: str | Path | None = None,
    progress: Progress | None = None,
) -> MonteCarlo:
    """Play a scene `runs` times, each with parameters of its own.

    law: a controller of the scene's period, or what designs one for the scene, as LQR.for_scene. ranges: smallest and
    largest factor by name of parameter, as `Plant.vary` names them, drawn uniformly: a stiffness of 0.64 to 1.44 times
    its own is a frequency within 20 %. noise: of readings, as sensors have it. delay: control periods. A run depends on
    (seed, its number) alone, not on `runs`, `jobs` or the backend of joblib, "dask" and "ray" among them. kept: a file
    of JSON lines that holds the runs done, is read first and added to; ValueError where it holds those of others: of
    another scene, seed, or design of the law, every array and nested law of it counted.

    Example
    -------
    >>> found = monte_carlo(scene, law, {"payload.mass": (0.8, 1.2)}, runs=4)
    >>> len(found.rows), len(found.failures)
    (4, 0)
    """
    require_instance("monte_carlo.scene", scene, Scene)
    given = require_mapping("monte_carlo.ranges", ranges)
    if not given:
        raise ValueError("monte_carlo.ranges = {} must name at least one parameter")
    factors = tuple((path, *_ends(path, pair)) for path, pair in given.items())
    runs = require_count("monte_carlo", "runs", runs, 1, 10_000_000)
    seed = require_count("monte_carlo", "seed", seed, 0, 2**32 - 1)
    noise, delay = (
        require_flag("monte_carlo.noise", noise),
        require_count("monte_carlo", "delay", delay, 0, scene.steps),
    )
    jobs = machine.processes("monte_carlo", jobs)
    require_choice("monte_carlo", "backend", backend, BACKENDS)
    if progress is not None:
        require_function("monte_carlo.progress", progress)
    told, path = progress or silent, None if kept is None else require_path("monte_carlo.kept", kept)
    played = dataclasses.replace(scene, randomise=factors)
    designed = _designed(law, scene)
    mark = "" if path is None else _mark(played, designed, seed, noise, delay)
    rows = _done(path, mark, runs)
    left = [k for k in range(runs) if k not in rows]
    told(len(rows) / runs, f"{len(rows)} done before")
    tasks = [(played, designed, seed, k, noise, delay) for k in left]
    for row in as_they_come("monte_carlo", trial, tasks, jobs, backend):
        rows[row["number"]] = row
        if path is not None:
            add_line(path, {"study": mark, **row})
        told(len(rows) / runs, f"run {row['number']}{', failed' if row['failure'] else ''}")
    return MonteCarlo(tuple(rows[k] for k in sorted(rows)))


def _designed(law: Any, scene: Scene) -> Controller:
    """The controller, or what `law` makes of the scene."""
    if isinstance(law, Controller) and not isinstance(law, type):
        return law
    make = require_function("monte_carlo.law", law)
    try:
        found: Controller = make(scene)
    except TypeError as error:
        raise ValueError(f"monte_carlo.law = {shown(law)} must design a controller for a scene: {error}") from error
    return require_instance("monte_carlo.law", found, Controller, what="a controller, or a function that makes one")


def _ends(path: str, pair: Any) -> tuple[float, float]:
    """(smallest, largest) factor."""
    if not isinstance(pair, (tuple, list)) or len(pair) != 2:
        raise ValueError(f"monte_carlo.ranges[{path!r}] = {pair!r} must be (smallest, largest) factor")
    low, high = (require_number(f"monte_carlo.ranges[{path!r}]", value, "positive") for value in pair)
    if not low <= high:
        raise ValueError(f"monte_carlo.ranges[{path!r}] = ({low!r}, {high!r}) must be smallest <= largest")
    return low, high


def _mark(scene: Scene, law: Controller, seed: int, noise: bool, delay: int) -> str:
    """What the rows of one study have in common: scene and law as they travel, the law as `reset` leaves it."""
    import joblib

    try:
        fresh = deepcopy(law)
        fresh.reset()
        return str(joblib.hash((scene, fresh, seed, noise, delay)))
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        raise ValueError(
            f"monte_carlo.kept needs a law whose design can be told from others: {shown(law)} does not pickle: {error}"
        ) from error


def _done(path: Path | None, mark: str, runs: int) -> dict[int, Row]:
    """Rows by number that the file holds."""
    found = {}
    for row in read_lines(path):
        if row.get("study") != mark:
            raise ValueError(f"monte_carlo.kept = {str(path)!r} holds the runs of another study; name another file")
        if row["number"] < runs:
            found[row["number"]] = {name: value for name, value in row.items() if name != "study"}
    return found

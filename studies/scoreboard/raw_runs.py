"""Every run of a board as arrays: what its rows, intervals and profiles are made from, in one small .npz file.

One row a run, columns (n,): scene, case, controller (places in the lists of names), number, cost, bound (NaN where it
was not sought), settling [s], peak, residual [m], at_limit, beyond, effort [-], failure (place in the list of reasons,
-1 where it lasted), act_median and act_p99 [us] of the run's calls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.files import sealed_arrays
from pliant.studies.closed_loop.scores import Score

KIND, FORMAT = "pliant scoreboard runs", 1
MEASURED = ("cost", "settling", "peak", "residual", "at_limit", "beyond", "effort")
TIMED = ("act_median", "act_p99")  # measured anew in every run: not compared
PLACES = ("scene", "case", "controller", "number", "failure")


@dataclass(frozen=True, eq=False)
class RawRuns(OwnsArrays):
    """Names, and columns by name; `about`: suite, seed, seeds, and what else was told of the board."""

    about: Mapping[str, Any]
    scenes: tuple[str, ...]
    cases: tuple[str, ...]
    controllers: tuple[str, ...]
    reasons: tuple[str, ...]
    columns: Mapping[str, np.ndarray]

    def rows(self, scene: str, case: str, controller: str) -> np.ndarray:
        """Places (k,) of a cell's runs, in the order of their numbers; none where it has none."""
        names = zip((self.scenes, self.cases, self.controllers), (scene, case, controller), strict=True)
        if not all(name in known for known, name in names):
            return np.zeros(0, dtype=int)
        c = self.columns
        found = (c["scene"] == self.scenes.index(scene)) & (c["case"] == self.cases.index(case))
        return np.flatnonzero(found & (c["controller"] == self.controllers.index(controller)))

    def column(self, name: str, scene: str, case: str, controller: str) -> np.ndarray:
        """(k,) of a cell."""
        return np.asarray(self.columns[name][self.rows(scene, case, controller)])

    def scores(self, scene: str, case: str, controller: str) -> np.ndarray:
        """bound / cost (k,) of the runs whose bound is known: 1 is the best that can be done, 0 a cost without end."""
        at = self.rows(scene, case, controller)
        best, cost = self.columns["bound"][at], self.columns["cost"][at]
        known = np.isfinite(best)
        return np.asarray(best[known] / cost[known])

    def save(self, path: Path) -> None:
        """Bytes that depend on the content alone."""
        lists = {"scenes": self.scenes, "cases": self.cases, "controllers": self.controllers, "reasons": self.reasons}
        about = {**self.about, **{name: list(values) for name, values in lists.items()}}
        sealed_arrays.save(path, KIND, FORMAT, about, dict(self.columns))

    @classmethod
    def load(cls, path: str | Path) -> RawRuns:
        """What `save` wrote. ValueError for any other file."""
        about, columns, _ = sealed_arrays.load("RawRuns.load", path, KIND, FORMAT)
        told = dict(about or {})
        scenes, cases, controllers, reasons = (
            tuple(told.pop(name, ())) for name in ("scenes", "cases", "controllers", "reasons")
        )
        wanted = {*PLACES, *MEASURED, "bound", *TIMED}
        if set(columns) != wanted:
            raise ValueError(f"RawRuns.load: {str(path)!r} has columns {sorted(columns)}, must have {sorted(wanted)}")
        return cls(told, scenes, cases, controllers, reasons, columns)


def gathered(
    about: Mapping[str, Any],
    cells: Mapping[tuple[str, str, str], tuple[Sequence[Score], Sequence[np.ndarray]]],
    bounds: Mapping[tuple[str, str], Sequence[float | None]],
) -> RawRuns:
    """From the scores and the times of act [ns] of each run by (scene, case, controller)."""
    scenes, cases, players = (tuple(dict.fromkeys(key[i] for key in cells)) for i in range(3))
    reasons: dict[str, int] = {}
    columns: dict[str, list[float]] = {name: [] for name in (*PLACES, *MEASURED, "bound", *TIMED)}
    for (scene, case, player), (scores, times) in cells.items():
        best = bounds[scene, case]
        for k, (one, act) in enumerate(zip(scores, times, strict=True)):
            values = {name: getattr(one, name) for name in MEASURED}
            values |= {"scene": scenes.index(scene), "case": cases.index(case), "controller": players.index(player)}
            values |= {"number": k, "bound": best[k] if k < len(best) else None}
            values["failure"] = reasons.setdefault(one.failure, len(reasons)) if one.failure else -1
            values["act_median"] = float(np.median(act)) / 1e3 if len(act) else None
            values["act_p99"] = float(np.quantile(act, 0.99)) / 1e3 if len(act) else None
            for name, column in columns.items():
                column.append(np.nan if values[name] is None else values[name])
    whole = {name: np.array(column, dtype=np.int32 if name in PLACES else float) for name, column in columns.items()}
    return RawRuns(dict(about), scenes, cases, players, tuple(reasons), whole)

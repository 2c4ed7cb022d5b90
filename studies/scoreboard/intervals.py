"""The numbers of a board with their intervals: row by row, and over scenes.

Row       interquartile mean of cost / bound, and 95 % intervals of every number by the bootstrap of the row's runs;
          none where a case is one run. Shares of failures: Clopper and Pearson's
Overall   of a case, over the scenes that a controller plays: interquartile mean of bound / cost; the probability that
          it does better than another on a run of a scene that both play; profiles
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.studies.closed_loop.scores import Row

from .raw_runs import RawRuns
from .statistics import improvement, interquartile_mean, interval, mean_of_middle, of_runs, profile, share_interval

AGAINST = "LQR"  # whom the probabilities of improvement are told against, where it plays


def with_intervals(row: Row, raw: RawRuns) -> Row:
    """The row with the interquartile mean of its ratios and with intervals by the row's own names."""
    if not row.runs:
        return row
    at = raw.rows(row.scene, row.case, row.controller)
    c = {name: values[at] for name, values in raw.columns.items()}
    known = np.isfinite(c["bound"])
    ratios = c["cost"][known] / c["bound"][known]
    middle = float(interquartile_mean(ratios)) if len(ratios) else None
    if row.runs == 1:
        return dataclasses.replace(row, ratio_iqm=middle)
    low, high = share_interval(row.failures, row.runs)
    found: dict[str, tuple[float, float] | None] = {"failures": (row.runs * low, row.runs * high)}
    if len(ratios) > 1:
        found["ratio_iqm"] = of_runs(interquartile_mean, ratios)
        found["ratio_median"] = of_runs(_median, ratios)
        pairs = np.stack([c["cost"][known], c["bound"][known]], axis=-1)
        found["ratio"] = _of_pairs(pairs)
    for name, of in (("cost", _mean), ("at_limit", _mean), ("beyond", _mean), ("effort", _mean), ("peak", _most)):
        found[name] = _among(c[name], of)
    for name in ("settling", "residual", "act_median", "act_p99"):
        found[name] = _among(c[name], _median)
    return dataclasses.replace(row, ratio_iqm=middle, intervals={k: v for k, v in found.items() if v is not None})


def _mean(values: np.ndarray) -> np.ndarray:
    return np.asarray(values.mean(axis=-1))


def _median(values: np.ndarray) -> np.ndarray:
    return np.asarray(np.quantile(values, 0.5, axis=-1, method="nearest"))


def _most(values: np.ndarray) -> np.ndarray:
    return np.asarray(values.max(axis=-1))


def _among(values: np.ndarray, of: Any) -> tuple[float, float] | None:
    """The interval of what has a value; None for fewer than two. Infinite: never settled."""
    values = values[~np.isnan(values)]
    return of_runs(of, values) if len(values) > 1 else None


def _of_pairs(pairs: np.ndarray) -> tuple[float, float]:
    """Of mean cost over mean bound, the runs drawn as pairs (n, 2)."""
    places = np.arange(len(pairs), dtype=float)

    def quotient(drawn: np.ndarray) -> np.ndarray:
        cost, best = np.moveaxis(pairs[drawn.astype(int)].mean(axis=-2), -1, 0)
        return np.asarray(cost / best)

    return of_runs(quotient, places)


def overall(raw: RawRuns) -> list[dict[str, Any]]:
    """A line a case and controller: scenes played, IQM of bound / cost, P(better than LQR), each with its interval."""
    lines = []
    for case in raw.cases:
        for name in raw.controllers:
            tasks = played(raw, case, name)
            if not tasks:
                continue
            own = list(tasks.values())
            line: dict[str, Any] = {"case": case, "controller": name, "scenes": len(tasks)}
            line["iqm"], line["iqm_interval"] = float(mean_of_middle(own)), interval(mean_of_middle, own)
            other = played(raw, case, AGAINST)
            both = [scene for scene in tasks if scene in other]
            if both and name != AGAINST:
                pair = [tasks[s] for s in both], [other[s] for s in both]
                line["better"], line["better_interval"] = float(improvement(*pair)), interval(improvement, *pair)
            lines.append(line)
    return lines


def played(raw: RawRuns, case: str, controller: str) -> dict[str, np.ndarray]:
    """bound / cost of a controller's runs by scene, where there are any with a bound."""
    found = {scene: raw.scores(scene, case, controller) for scene in raw.scenes}
    return {scene: scores for scene, scores in found.items() if len(scores)}


def profiles(raw: RawRuns, case: str, at: Sequence[float] | np.ndarray) -> dict[str, np.ndarray]:
    """F(tau) (len(at),) by controller, over the scenes that it plays."""
    found = {name: list(played(raw, case, name).values()) for name in raw.controllers}
    return {name: profile(tasks, np.asarray(at)) for name, tasks in found.items() if tasks}

"""Finished pieces of a board's work in a file of JSON lines, so that a killed board goes on where it was.

A line is one task: what marks it (the suite, Pliant's version, scene, case, law, runs and seed, as they travel between
processes) and its result, numbers in full. What was kept is not played again, so that no digit of it changes, the times
of act among them.
"""

from __future__ import annotations

import dataclasses
import pickle
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import shown
from pliant.studies.closed_loop.scores import Score
from pliant.studies.common import machine
from pliant.studies.common.json_lines import add_line, read_lines

from .results import Entry, Line

SUITE = "pliant-scoreboard-2"


def marked(task: tuple[Any, ...], seed: int) -> str:
    """What tells a task (scene, case, name, maker, first, last) from all others."""
    import joblib

    try:
        return str(joblib.hash((SUITE, machine.version("pliant"), task, seed)))
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        raise ValueError(
            f"scoreboard.kept needs laws that travel between processes: {shown(task[3])}: {error}"
        ) from error


def read(path: Path | None) -> dict[str, Any]:
    """Results as `work` returns them, (key, first, result), by mark. ValueError where the file holds anything else."""
    found = {}
    for row in read_lines(path):
        if row.get("suite") != SUITE:
            raise ValueError(f"scoreboard.kept = {str(path)!r} holds no runs of {SUITE}; name another file")
        found[row["mark"]] = (tuple(row["key"]), row["first"], _result(row["kind"], row["result"]))
    return found


def add(path: Path, mark: str, told: tuple[tuple[str, str, str], int, Any]) -> None:
    """Keep one more."""
    key, first, result = told
    kind, plain = _plain(result)
    add_line(path, {"suite": SUITE, "mark": mark, "key": key, "first": first, "kind": kind, "result": plain})


def _plain(result: Any) -> tuple[str, Any]:
    if isinstance(result, str):
        return "reason", result
    if isinstance(result, Entry):
        return "entry", {**vars(result), "noise": dict(result.noise)}
    if len(result) == 3:
        costs, reason, line = result
        return "bounds", [costs, reason, _line(line)]
    scores, times, line, counts = result
    return "runs", [[dataclasses.asdict(s) for s in scores], [t.tolist() for t in times], _line(line), counts]


def _line(line: Line | None) -> Any:
    if line is None:
        return None
    return [line.t.tolist(), {name: values.tolist() for name, values in line.signals.items()}, line.u.tolist()]


def _result(kind: str, plain: Any) -> Any:
    if kind == "reason":
        return plain
    if kind == "entry":
        varied = tuple((name, low, high) for name, low, high in plain["varied"])
        return Entry(**{**plain, "limits": tuple(plain["limits"]), "varied": varied})
    if kind == "bounds":
        costs, reason, line = plain
        return costs, reason, _drawn(line)
    scores, times, line, counts = plain
    return [Score(**s) for s in scores], [np.array(t, dtype=np.int64) for t in times], _drawn(line), counts


def _drawn(plain: Any) -> Line | None:
    if plain is None:
        return None
    t, signals, u = plain
    return Line(np.array(t), {name: np.array(values) for name, values in signals.items()}, np.array(u))

"""The suite "pliant-scoreboard-2": every controller on every scene, beside the best that can be done.

exact        the design model itself, as the scene is: no model error
finer        the plant one fidelity higher (see `evaluation_scene`), as the scene is
varied       the finer plant; payload, stiffness and damping by +-30 %, start, gusts and parameters as the scene draws
             them; noise on every reading. No delay
delayed      the finer plant; start and gusts as the scene draws them, each input one control period late. Parameters
             are its own, readings without noise
all at once  the runs of "varied", and each input acts one control period late
Each run has its own bound (see `optimal_bound`), so that costs can be told as ratios to the best. The first suite had
four cases: its "delayed" is "all at once" here, run by run.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pliant.envs.scenes.registry import is_file
from pliant.envs.scenes.registry import names as named
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import (
    require_choice,
    require_count,
    require_function,
    require_path,
    require_text,
    shown,
)
from pliant.studies.closed_loop.contestants import CONTESTANTS, VARIANTS, Maker, playable
from pliant.studies.closed_loop.scores import Row, Score, summarise
from pliant.studies.common import machine
from pliant.studies.common.parallel import BACKENDS, as_they_come
from pliant.studies.common.reference_motions import Progress, silent

from . import kept_tasks
from .intervals import with_intervals
from .raw_runs import gathered
from .results import Entry, Line, Results
from .tables import table, write
from .tasks import CASES, CHUNK, MANY, played_scene, work

BOUNDS = 16  # runs of a case whose bound is found, at most
FEWEST = 1
STATES = 24_000  # states over all periods, all of these runs together: where a scene has many, fewer bounds are found


class Scoreboard(Results):
    """What `scoreboard` returns: the results, which can be written."""

    def to_json(self) -> dict[str, Any]:
        return table(self)

    def save(self, folder: str | Path, command: str = "") -> list[Path]:
        """Write scoreboard.json, scoreboard.md and one picture a scene."""
        return write(self, require_path("Scoreboard.save: folder", folder), command)


def scoreboard(
    scenes: Sequence[str | Scene] | None = None,
    controllers: Sequence[str] | Mapping[str, Maker] | None = None,
    *,
    seeds: int = 64,
    seed: int = 0,
    jobs: int | None = None,
    bounds: int = BOUNDS,
    backend: str = "loky",
    kept: str | Path | None = None,
    progress: Progress | None = None,
) -> Scoreboard:
    """Score `controllers` on `scenes`, in all cases, with `seeds` runs of the last three.

    scenes       names, those of `contestants.VARIANTS` included, or scenes; all that have inputs where None
    controllers  names of `contestants.CONTESTANTS`, or functions that make one from a scene, by name; all where None
    jobs         processes; as many as cores where None
    bounds       runs of a case whose bound is found: ratios are of those runs, costs of all
    backend      joblib's, "dask" and "ray" among them: a cluster plays the same runs
    kept         a file of JSON lines to which each finished piece of work is added and which is read first: a board
                 that was killed goes on where it was

    The runs depend on `seed` and their number alone, not on `seeds`, `jobs` or `backend`; the times of act are measured
    in the same runs, while the other processes work. A controller that cannot be designed has rows that say why.

    Example
    -------
    >>> board = scoreboard(["single-link-slew"], ["LQR", "MPC"], seeds=8, bounds=4, kept="board.jsonl")
    >>> board.row("single-link-slew", "all at once", "LQR").ratio_iqm > 1
    True
    """
    seeds = require_count("scoreboard", "seeds", seeds, 1, 100_000)
    seed = require_count("scoreboard", "seed", seed, 0, 2**32 - 1)
    bounds = require_count("scoreboard", "bounds", bounds, 0, 100_000)
    jobs = machine.cores() if jobs is None else machine.processes("scoreboard", jobs)
    if progress is not None:
        require_function("scoreboard.progress", progress)
    found, makers = _scenes(scenes), _makers(controllers)
    told = progress or silent
    told(0.0, "start")
    tasks = list(_tasks(found, makers, seeds, min(bounds, seeds)))
    require_choice("scoreboard", "backend", backend, BACKENDS)
    path = None if kept is None else require_path("scoreboard.kept", kept)
    before = kept_tasks.read(path)
    marks = [] if path is None else [kept_tasks.marked(task, seed) for task in tasks]
    done = [before[mark] for mark in marks if mark in before]
    left = [k for k in range(len(tasks)) if not marks or marks[k] not in before]
    results: dict[tuple[str, str, str], dict[int, Any]] = {}
    entries: dict[str, Entry] = {}
    told(len(done) / len(tasks), f"{len(done)} pieces done before")
    given = [(k, *tasks[k], seeds, seed) for k in left]
    for number, (k, piece) in enumerate(_pieces(done, as_they_come("scoreboard", _piece, given, jobs, backend)), 1):
        key, first, result = piece
        if key[1] == "entry":
            entries[key[0]] = result
        else:
            results.setdefault(key, {})[first] = result
        if k is not None:
            if path is not None:
                kept_tasks.add(path, marks[k], piece)
            told(number / len(tasks), f"{key[0]}, {key[2] or key[1]}")
    return _gathered(found, makers, results, entries, seeds, seed)


def _piece(number: int, *task: Any) -> tuple[int, Any]:
    """One task with its number, in a process of its own."""
    return number, work(*task)


def _pieces(done: Sequence[Any], coming: Iterator[Any]) -> Iterator[tuple[int | None, Any]]:
    """(None, piece) of those that were kept, then (number, piece) as they come."""
    yield from ((None, piece) for piece in done)
    yield from coming


def _scenes(wanted: Sequence[str | Scene] | None) -> tuple[Scene, ...]:
    if wanted is None:
        return playable()
    if not isinstance(wanted, (tuple, list)):
        raise ValueError(f"scoreboard.scenes = {shown(wanted)} must be a tuple of names or scenes")
    for w in wanted:
        if not isinstance(w, Scene) and not is_file(w):
            require_choice("scoreboard", "scenes", w, (*named(), *VARIANTS))
    found = [scene for w in wanted for scene in ((w,) if isinstance(w, Scene) else playable((w,)))]
    if not found:
        raise ValueError(f"scoreboard: scenes = {wanted} must hold at least one scene with inputs")
    return tuple(found)


def _makers(wanted: Sequence[str] | Mapping[str, Maker] | None) -> dict[str, Maker]:
    if isinstance(wanted, Mapping) and wanted:
        return {
            require_text("scoreboard.controllers", name): require_function(f"scoreboard.controllers[{name!r}]", make)
            for name, make in wanted.items()
        }
    if wanted is not None and not (isinstance(wanted, (tuple, list)) and wanted):
        raise ValueError(f"scoreboard.controllers = {shown(wanted)} must be a tuple of names, or functions by name")
    for name in wanted or ():
        require_choice("scoreboard", "controllers", name, tuple(CONTESTANTS))
    return {name: CONTESTANTS[name] for name in (wanted or CONTESTANTS)}


def _tasks(found: Sequence[Scene], makers: dict[str, Maker], seeds: int, bounds: int) -> Iterator[tuple[Any, ...]]:
    """(scene, case, controller or "bound", its maker, first run, last run + 1), the longest first."""
    yield from ((scene, "entry", "", None, 0, 0) for scene in found)
    for scene in found:
        for case in CASES:
            share = max(FEWEST, STATES // (scene.steps * scene.plant.nx))
            count = min(bounds, share) if case in MANY else 1
            yield from ((scene, case, "bound", None, k, min(k + 4, count)) for k in range(0, count, 4))
    for scene in found:
        for name, maker in makers.items():
            for case in CASES:
                count = seeds if case in MANY else 1
                yield from ((scene, case, name, maker, k, min(k + CHUNK, count)) for k in range(0, count, CHUNK))


def _gathered(
    found: Sequence[Scene],
    makers: dict[str, Maker],
    kept: dict[tuple[str, str, str], dict[int, Any]],
    entries: dict[str, Entry],
    seeds: int,
    seed: int,
) -> Scoreboard:
    rows: list[Row] = []
    cells: dict[tuple[str, str, str], tuple[list[Score], list[np.ndarray]]] = {}
    bounds: dict[tuple[str, str], tuple[float | None, ...]] = {}
    remarks: dict[tuple[str, str], str] = {}
    lines: dict[tuple[str, str], Line] = {}
    for scene in found:
        for case in CASES:
            parts = [part for _, part in sorted(kept.get((scene.name, case, "bound"), {}).items())]
            best = tuple(cost for costs, _, _ in parts for cost in costs)
            bounds[scene.name, case] = best
            remarks[scene.name, case] = next((reason for _, reason, _ in parts if reason), "")
            for *_, line in parts:
                if line is not None:
                    lines[scene.name, "bound"] = line
            for name in makers:
                results = [part for _, part in sorted(kept[scene.name, case, name].items())]
                reason = next((r for r in results if isinstance(r, str)), "")
                if reason:
                    rows.append(Row(scene.name, case, name, 0, reason=reason))
                    continue
                scores: list[Score] = [s for part, *_ in results for s in part]
                times = [act for _, part, *_ in results for act in part]
                cells[scene.name, case, name] = scores, times
                row = summarise(scene.name, case, name, scores, np.concatenate(times), best)
                counts: Counter[str] = Counter()
                for *_, own in results:
                    counts.update(own)
                rows.append(dataclasses.replace(row, record=dict(counts)))
                if results[0][2] is not None:
                    lines[scene.name, name] = results[0][2]
    about = {"suite": kept_tasks.SUITE, "seeds": seeds, "seed": seed, "version": machine.version("pliant")}
    raw = gathered(about, cells, bounds)
    return Scoreboard(
        seeds,
        seed,
        tuple(entries[scene.name] for scene in found),
        tuple(with_intervals(row, raw) for row in rows),
        bounds,
        remarks,
        {scene.name: played_scene(scene, "finer")[0] for scene in found},
        lines,
        raw,
    )

"""Every controller on every scene, beside the best that can be done.

exact    the design model itself, as the scene is: no model error
finer    the plant one fidelity higher (see `evaluation_scene`), as the scene is
varied   the finer plant; payload, stiffness and damping by +-30 %, start, gusts and parameters as the scene draws them;
         noise on every reading
delayed  the same runs, and each input acts one control period late
Each run has its own bound (see `optimal_bound`), so that costs can be told as ratios to the best.
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
from pliant.studies.common.reference_motions import Progress, silent

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
    progress: Progress | None = None,
) -> Scoreboard:
    """Score `controllers` on `scenes`, in all cases, with `seeds` runs of the varied and the delayed one.

    scenes       names, those of `contestants.VARIANTS` included, or scenes; all that have inputs where None
    controllers  names of `contestants.CONTESTANTS`, or functions that make one from a scene, by name; all where None
    jobs         processes; as many as cores where None
    bounds       runs of a case whose bound is found: ratios are of those runs, costs of all

    The runs depend on `seed` and their number alone, not on `seeds` or `jobs`; the times of act are measured in the
    same runs, while the other processes work. A controller that cannot be designed has rows that say why.
    """
    from joblib import Parallel, delayed

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
    kept: dict[tuple[str, str, str], dict[int, Any]] = {}
    entries: dict[str, Entry] = {}
    pool = Parallel(n_jobs=jobs, return_as="generator_unordered", batch_size=1)
    for done, (key, first, result) in enumerate(pool(delayed(work)(*task, seeds, seed) for task in tasks), 1):
        if key[1] == "entry":
            entries[key[0]] = result
        else:
            kept.setdefault(key, {})[first] = result
        told(done / len(tasks), f"{key[0]}, {key[2] or key[1]}")
    return _gathered(found, makers, kept, entries, seeds, seed)


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
                row = summarise(scene.name, case, name, scores, np.concatenate([r[1] for r in results]), best)
                counts: Counter[str] = Counter()
                for *_, own in results:
                    counts.update(own)
                rows.append(dataclasses.replace(row, record=dict(counts)))
                if results[0][2] is not None:
                    lines[scene.name, name] = results[0][2]
    return Scoreboard(
        seeds,
        seed,
        tuple(entries[scene.name] for scene in found),
        tuple(rows),
        bounds,
        remarks,
        {scene.name: played_scene(scene, "finer")[0] for scene in found},
        lines,
    )

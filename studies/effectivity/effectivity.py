"""Predicted over true error on random scenes, in parallel, and what `choose` made of it.

Rows go to a file of JSON lines as they come, so that a study goes on where it was stopped; on this machine or, by
joblib's backends "dask" and "ray", on a cluster.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pliant.plants.core.argument_gates import require_choice, require_count, require_function, require_path
from pliant.studies.common import machine
from pliant.studies.common.json_lines import add_line, read_lines
from pliant.studies.common.parallel import BACKENDS, as_they_come
from pliant.studies.common.reference_motions import Progress, silent

from .tally import Row, Tally
from .trial import trial


@dataclass(frozen=True, eq=False)
class Effectivity:
    """Rows by seed, and what they come to."""

    rows: tuple[Row, ...]

    @property
    def tally(self) -> Tally:
        """The numbers that are claimed."""
        return Tally(self.rows)

    def to_json(self) -> dict[str, Any]:
        return {"summary": self.tally.numbers, "rows": list(self.rows)}


def effectivity(
    seeds: Sequence[int],
    *,
    jobs: int = 1,
    backend: str = "loky",
    kept: str | Path | None = None,
    progress: Progress | None = None,
) -> Effectivity:
    """`trial` of each seed. kept: the file of JSON lines that holds the rows done, is read first and added to.

    Example
    -------
    >>> found = effectivity(range(60), jobs=2, kept="effectivity.jsonl")
    >>> found.tally.numbers["within 0.5 to 2"]
    """
    wanted = [require_count("effectivity", "seeds", k, 0, 2**32 - 1) for k in seeds]
    if not wanted:
        raise ValueError("effectivity.seeds = () must hold at least one seed")
    jobs = machine.processes("effectivity", jobs)
    require_choice("effectivity", "backend", backend, BACKENDS)
    if progress is not None:
        require_function("effectivity.progress", progress)
    told, path = progress or silent, None if kept is None else require_path("effectivity.kept", kept)
    rows = {row["seed"]: row for row in read_lines(path) if row["seed"] in set(wanted)}
    left = [k for k in wanted if k not in rows]
    told(1 - len(left) / len(wanted), f"{len(rows)} done before")
    for row in as_they_come("effectivity", trial, [(k,) for k in left], jobs, backend):
        rows[row["seed"]] = row
        if path is not None:
            add_line(path, row)
        told(len(rows) / len(wanted), f"seed {row['seed']}")
    return Effectivity(tuple(rows[k] for k in sorted(rows)))

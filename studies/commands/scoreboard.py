"""`pliant scoreboard [SCENE ...]`: every controller on every scene, beside the best that can be done."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from pliant.studies.scoreboard.scoreboard import BOUNDS
from pliant.studies.scoreboard.scoreboard import scoreboard as score
from pliant.studies.scoreboard.tables import HEAD, WORDS, cells, table

from .console import bar, print_json, show, writable_folder
from .options import AsJson

QUICK = (8, 4)  # runs and bounds of `--quick`


def scoreboard(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(help="Scenes by name or file; all with inputs, and their variants, if not given."),
    ] = None,
    seeds: Annotated[int, typer.Option(help="Runs of each varied case.")] = 64,
    controllers: Annotated[str | None, typer.Option(help="Names, separated by commas; all if not given.")] = None,
    seed: Annotated[int, typer.Option(help="Of everything drawn at random.")] = 0,
    jobs: Annotated[int | None, typer.Option(help="Processes; as many as cores if not given.")] = None,
    bounds: Annotated[int | None, typer.Option(help="Runs of each case with a bound; 16 if not given.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="8 runs of each case and 4 bounds.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for the tables and the pictures.")] = None,
    as_json: AsJson = False,
) -> None:
    """Score every controller on every scene: cost, and its ratio to the least that is possible."""
    runs, found = QUICK if quick else (seeds, BOUNDS if bounds is None else bounds)
    words = ["pliant", "scoreboard", *(scenes or ()), *(["--quick"] if quick else [])]
    given: dict[str, Any] = {"--seeds": None if quick or seeds == 64 else seeds, "--controllers": controllers}
    given |= {"--bounds": bounds, "--seed": seed or None, "--out": out}
    command = shlex.join([*words, *(w for key, value in given.items() if value is not None for w in (key, str(value)))])
    chosen = [name.strip() for name in controllers.split(",")] if controllers is not None else None
    writable_folder("--out", out)
    with bar("scoreboard") as tell:
        board = score(scenes or None, chosen, seeds=runs, seed=seed, jobs=jobs, bounds=found, progress=tell)
    if out is not None:
        board.save(out, command)
    if as_json:
        print_json(table(board, command))
        return
    for entry in board.entries:
        for case, about in WORDS.items():
            rows = [row for row in board.rows if (row.scene, row.case) == (entry.scene, case)]
            known = [c for c in board.bounds[entry.scene, case] if c is not None]
            best = f"; bound {sum(known) / len(known):.4g}" if known else ""
            missing = [f"{row.controller}: {row.reason}" for row in rows if not row.runs]
            show(
                f"{entry.scene}, {case}",
                HEAD,
                [cells(row) for row in rows if row.runs],
                caption="\n".join([about + best, *missing]),
            )

"""`pliant scoreboard [SCENE ...]`: every controller on every scene, beside the best that can be done.

`pliant scoreboard verify [FOLDER]` plays a part of a board's runs again and compares.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from pliant.envs.scenes.registry import get
from pliant.plants import PliantError
from pliant.studies.closed_loop.contestants import CONTESTANTS, Maker, OfSeed
from pliant.studies.scoreboard.own_laws import OwnLaw
from pliant.studies.scoreboard.raw_runs import RawRuns
from pliant.studies.scoreboard.scoreboard import BOUNDS, Scoreboard
from pliant.studies.scoreboard.scoreboard import scoreboard as score
from pliant.studies.scoreboard.tables import HEAD, RUNS, WORDS, cells, table
from pliant.studies.scoreboard.verification import verify

from .console import bar, print_json, say, say_lines, show, writable_folder
from .options import AsJson

QUICK = (8, 4)  # runs and bounds of `--quick`
VERIFY = "verify"
FOLDER = Path("docs/scoreboard/suite-2")


def scoreboard(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            help="Scenes by name or file; all with inputs, and their variants, if not given. `verify FOLDER`: play a "
            "part of the runs that a board's folder holds again and compare."
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(help="Runs of each varied case.")] = 64,
    controllers: Annotated[str | None, typer.Option(help="Names, separated by commas; all if not given.")] = None,
    law: Annotated[
        list[str] | None,
        typer.Option(metavar="FILE.py:NAME", help="Your own law, played alone or beside --controllers."),
    ] = None,
    policies: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Training runs SCENE-SEED in it: the policy of each seed plays too."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Of everything drawn at random.")] = 0,
    jobs: Annotated[int | None, typer.Option(help="Processes; as many as cores if not given.")] = None,
    bounds: Annotated[int | None, typer.Option(help="Runs of each case with a bound; 16 if not given.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="8 runs of each case and 4 bounds.")] = False,
    backend: Annotated[str, typer.Option(help="joblib's: loky, dask, ray, ..")] = "loky",
    kept: Annotated[Path | None, typer.Option(help="File that holds finished work; a killed board goes on.")] = None,
    cells_again: Annotated[int, typer.Option("--cells", help="Runs that `verify` plays again.")] = 24,
    out: Annotated[Path | None, typer.Option(help="Folder for the tables, the runs and the pictures.")] = None,
    as_json: AsJson = False,
) -> None:
    """Score every controller on every scene: cost, and its ratio to the least that is possible."""
    own = _own(law) | _seeds(policies)
    if scenes and scenes[0] == VERIFY:
        _verify(scenes[1:], cells_again, seed, own, as_json)
        return
    runs, found = QUICK if quick else (seeds, BOUNDS if bounds is None else bounds)
    words = ["pliant", "scoreboard", *(scenes or ()), *(["--quick"] if quick else [])]
    given: dict[str, Any] = {"--seeds": None if quick or seeds == 64 else seeds, "--controllers": controllers}
    given |= {"--bounds": bounds, "--policies": policies, "--seed": seed or None, "--out": out}
    laws = [w for text in law or () for w in ("--law", text)]
    command = shlex.join(
        [*words, *laws, *(w for key, value in given.items() if value is not None for w in (key, str(value)))]
    )
    chosen: Any = [name.strip() for name in controllers.split(",")] if controllers is not None else None
    if policies is not None and chosen is None:
        chosen = list(CONTESTANTS)
    if own:
        unknown = [name for name in chosen or () if name not in CONTESTANTS]
        chosen = chosen if unknown else {**{name: CONTESTANTS[name] for name in chosen or ()}, **own}
    writable_folder("--out", out)
    _require_controllers(own, scenes)
    with bar("scoreboard") as tell:
        board = score(
            scenes or None,
            chosen,
            seeds=runs,
            seed=seed,
            jobs=jobs,
            bounds=found,
            backend=backend,
            kept=kept,
            progress=tell,
        )
    if out is not None:
        board.save(out, command)
    if as_json:
        print_json(table(board, command))
    else:
        _shown(board)


def _shown(board: Scoreboard) -> None:
    for entry in board.entries:
        for case, about in WORDS.items():
            rows = [row for row in board.rows if (row.scene, row.case) == (entry.scene, case)]
            known = [c for c in board.bounds[entry.scene, case] if c is not None]
            best = f"; bound {sum(known) / len(known):.4g}" if known else ""
            missing = [f"{row.controller}: {row.reason}" for row in rows if not row.runs]
            played = [cells(row, intervals=False) for row in rows if row.runs]
            caption = "\n".join([about + best, *missing])
            if played:
                show(f"{entry.scene}, {case}", HEAD, played, caption=caption)
            else:
                say(f"{entry.scene}, {case}: {caption}")


def _own(laws: list[str] | None) -> dict[str, Maker]:
    """Makers by the names of their classes or functions."""
    return {made.name: made for made in (OwnLaw.of(text) for text in laws or ())}


def _require_controllers(own: Mapping[str, Maker], names: list[str] | None) -> None:
    """PliantError, before bounds take minutes, where a law of one's own serves none of the scenes that are named."""
    for law in own.values() if names else ():
        refused: PliantError | ValueError | None = None
        for name in names or ():
            try:
                law(get(name))
            except (PliantError, ValueError) as error:
                refused = refused or error
            else:
                break
        else:
            if refused is not None:
                raise refused


def _seeds(folder: Path | None) -> dict[str, Maker]:
    """A maker a seed that any scene's training has in `folder`."""
    if folder is None:
        return {}
    seeds = {int(found[1]) for found in (re.fullmatch(r".*-(\d+)", one.name) for one in folder.glob("*/")) if found}
    if not seeds:
        raise ValueError(f"--policies {str(folder)!r} must hold folders SCENE-SEED with a policy in each")
    return {f"trained policy, seed {seed}": OfSeed(str(folder), seed) for seed in sorted(seeds)}


def _verify(words: list[str], cells_again: int, seed: int, own: Mapping[str, Maker], as_json: bool) -> None:
    """Exit code 1 where a run differs, or none could be played."""
    if len(words) > 1:
        raise ValueError(f"pliant scoreboard verify takes one folder, not {words}")
    raw = RawRuns.load(Path(words[0] if words else FOLDER) / RUNS)
    with bar("verify") as tell:
        found = verify(raw, cells=cells_again, seed=seed, makers=own, progress=tell)
    if as_json:
        print_json({"passed": found.passed, "replays": [vars(one) for one in found.replays], "skipped": found.skipped})
    else:
        say_lines(str(found))
    if not found.passed:
        raise typer.Exit(1)

"""`pliant chart`, `pliant choose`, `pliant study`: speed against accuracy, the smallest model, whether it is so."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.plants.core.argument_gates import require_choice
from pliant.plants.files.atomic_files import Together
from pliant.studies.charts.measure import chart as measure
from pliant.studies.common.atomic_files import dumps
from pliant.studies.common.formatting import measured
from pliant.studies.effectivity.effectivity import effectivity
from pliant.studies.fidelity.choice import choose as climb
from pliant.studies.figures.effectivity import effectivity as histogram
from pliant.studies.figures.ladder import ladder
from pliant.studies.figures.speed_accuracy import save as save_chart
from pliant.studies.figures.style import save

from .console import bar, complain, drawable, print_json, say, scene_with, show, writable
from .options import AsJson, Budget, Picture, SceneName, Settings


def chart(
    scene: SceneName,
    settings: Settings = None,
    budget: Budget = 15.0,
    out: Annotated[Path | None, typer.Option(help="Save the table as json.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Measure speed against accuracy: every variant of the plant, by every method, at several steps."""
    chosen = scene_with(scene, settings or [])
    writable("--out", out)
    drawable(plot)
    with bar(f"chart {chosen.name}") as tell:
        found = measure(chosen, budget=budget, progress=tell)
    with Together() as files:
        if out is not None:
            found.save(out, files)
        if plot is not None:
            save_chart(found, plot, files)
    if as_json:
        print_json(found.to_json())
        return
    for variant, words in found.outside:
        say(f"{variant} leaves the range of its kinematics: {words}.")
    front = sorted((r for r in found.measured if r.pareto), key=lambda r: r.error or 0.0)
    rows = [(r.variant, r.setting, (r.seconds or 0.0) * 1e3, r.error, r.step_error) for r in front]
    caption = (
        f"{len(found.measured)} settings measured, {len(found.failed)} without a result (see --json). "
        f"Errors are from physics, {found.reference.how}, known to "
        f"{measured(found.reference.uncertainty, found.unit)}."
    )
    head = ("variant", "method", "ms per simulated s", f"error [{found.unit}]", f"of it by the step [{found.unit}]")
    show(f"{chosen.name}, the Pareto front", head, rows, caption=caption)


def choose(
    scene: SceneName,
    settings: Settings = None,
    tolerance: Annotated[float | None, typer.Option(help="Largest error [m]; the scene's own if not given.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Find the smallest model that a scene needs. Exit code 1 where none is shown to be good enough."""
    chosen = scene_with(scene, settings or [])
    drawable(plot)
    with bar(f"choose {chosen.name}") as tell:
        found = climb(chosen, tolerance, progress=tell)
    if plot is not None:
        save(ladder(found), plot)
    if as_json:
        print_json(found.to_json())
    else:
        rows = [
            (
                r.variant,
                r.states,
                measured(r.error, found.unit) if r.error is not None else "-",
                measured(r.bound, found.unit) if r.bound is not None else "-",
                "chosen" if r.chosen else r.note,
            )
            for r in found.rungs
        ]
        show(f"{chosen.name}, the ladder", ("variant", "states", "from physics", "at most", ""), rows)
        say(found.text)
    if not found.met:
        complain("no variant is shown to keep the tolerance")
        raise typer.Exit(1)


def study(
    name: Annotated[str, typer.Argument(help="effectivity: predicted over true errors on random scenes.")],
    seeds: Annotated[str, typer.Option(metavar="FIRST:END", help="Which random scenes, END left out.")] = "0:60",
    jobs: Annotated[int, typer.Option(help="Processes; -1 is as many as cores.")] = -1,
    backend: Annotated[str, typer.Option(help="joblib's: loky, threading, dask, ray, ..")] = "loky",
    kept: Annotated[Path | None, typer.Option(help="File of rows; it goes on where that one ends.")] = None,
    out: Annotated[Path | None, typer.Option(help="Save the table as json.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Try what `choose` claims on random scenes. Exit code 1 where it was wrong, or crashed."""
    require_choice("study", "name", name, ("effectivity",))
    wanted = _range(seeds)
    for option, path in (("--kept", kept), ("--out", out)):
        writable(option, path)
    drawable(plot)
    with bar(f"study {name}") as tell:
        found = effectivity(wanted, jobs=jobs, backend=backend, kept=kept, progress=tell)
    with Together() as files:
        if out is not None:
            files.text(out, dumps(found.to_json()) + "\n")
        if plot is not None:
            save(histogram(found), plot, files)
    if as_json:
        print_json(found.to_json())
    else:
        show(f"effectivity on the scenes {seeds}", ("", ""), found.tally.lines())
    if found.tally.faulty:
        complain(f"{len(found.tally.wrong)} wrongly met, {len(found.tally.crashed)} crashed")
        raise typer.Exit(1)


def _range(text: str) -> range:
    """ "0:60", or one number."""
    first, _, end = text.partition(":")
    try:
        found = range(int(first), int(end or int(first) + 1))
    except ValueError:
        found = range(0)
    if not found or found[0] < 0:
        raise ValueError(f"--seeds {text!r} must be FIRST:END, whole numbers, 0 <= FIRST < END")
    return found

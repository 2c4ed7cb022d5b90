"""`pliant chart` and `pliant choose`: speed against accuracy, and the smallest model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.plants.files.atomic_files import Together
from pliant.studies.common.formatting import measured
from pliant.studies.fidelity.choice import choose as climb
from pliant.studies.fidelity.speed_accuracy import chart as measure
from pliant.studies.figures.speed_accuracy import ladder
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

"""`pliant chart`, `pliant choose`, `pliant study`: speed against accuracy, the smallest model, whether it is so."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from pliant.envs.scene_files.settings import with_settings
from pliant.envs.scenes import SCENES
from pliant.plants.core.argument_gates import require_choice
from pliant.plants.files.atomic_files import Together
from pliant.studies.charts.gallery import KEPT, gallery
from pliant.studies.charts.measure import chart as measure
from pliant.studies.charts.page import save_all
from pliant.studies.common.atomic_files import dumps
from pliant.studies.common.formatting import measured
from pliant.studies.common.reference_motions import Motions, share
from pliant.studies.effectivity.effectivity import effectivity
from pliant.studies.fidelity.choice import choose as climb
from pliant.studies.fidelity.speed_accuracy import Chart
from pliant.studies.figures.effectivity import effectivity as histogram
from pliant.studies.figures.speed_accuracy import save as save_chart
from pliant.studies.figures.style import save

from .console import bar, complain, drawable, print_json, say, show, writable, writable_folder
from .options import AsJson, Budget, Picture, SceneName, Settings


def chart(
    scene: Annotated[str | None, typer.Argument(help="A scene's name; `pliant scenes` lists them.")] = None,
    settings: Settings = None,
    budget: Budget = 15.0,
    out: Annotated[Path | None, typer.Option(help="Folder of page, picture and table, or a json file.")] = None,
    plot: Picture = None,
    kept: Annotated[Path | None, typer.Option(help="File of rows; it goes on where that one ends.")] = None,
    physics: Annotated[
        float | None, typer.Option("--physics-tolerance", help="For which physics is sought; a tenth of the scene's.")
    ] = None,
    peers: Annotated[bool, typer.Option("--peers", help="Other programs on the same motion too.")] = False,
    every: Annotated[bool, typer.Option("--all", help="Every shipped scene, with a page of all, into --out.")] = False,
    as_json: AsJson = False,
) -> None:
    """Measure speed against accuracy: every variant of the plant, by every path and method, at several steps.

    Exit code 1 where the budget does not buy each variant a row.
    """
    if every:
        _every_chart(scene, settings, out, budget, peers, as_json)
        return
    if scene is None:
        raise ValueError("chart: name a scene, or give --all and --out")
    chosen = with_settings(scene, settings or [])
    folder = out if out is not None and out.suffix != ".json" else None
    table = out if folder is None else None
    writable("--out", table)
    writable_folder("--out", folder)
    writable("--kept", kept)
    drawable(plot)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        kept = folder / f"{chosen.name}{KEPT}" if kept is None else kept
    with bar(f"chart {chosen.name}") as tell:
        own: dict[str, Any] = {"physics_tolerance": physics, "kept": kept, "peers": peers}
        found = measure(chosen, budget=budget, progress=tell, **own)
    if folder is not None:
        save_all(found, folder, about=chosen.about)
    with Together() as files:
        if table is not None:
            found.save(table, files)
        if plot is not None:
            save_chart(found, plot, files)
    if as_json:
        print_json(found.to_json())
    else:
        _show_front(found)
    if found.needed is not None:
        complain(_too_little(found))
        raise typer.Exit(1)


def _every_chart(
    scene: str | None, settings: list[str] | None, out: Path | None, budget: float, peers: bool, as_json: bool
) -> None:
    """The gallery."""
    if scene is not None or settings:
        raise ValueError("chart --all charts every shipped scene as it is: no SCENE and no --set beside it")
    if out is None:
        raise ValueError("chart --all needs --out, a folder")
    writable_folder("--out", out)
    with bar("chart --all") as tell:
        charts = gallery(out, budget=budget, peers=peers, progress=tell)
    if as_json:
        print_json([found.to_json() for found in charts])
    else:
        print(out / "index.html")
    lacking = [found for found in charts if found.needed is not None]
    for found in lacking:
        complain(f"{found.scene}: {_too_little(found)}")
    if lacking or len(charts) < len(SCENES):
        raise typer.Exit(1)


def _too_little(found: Chart) -> str:
    """Which budget it takes."""
    return (
        f"the budget of {found.budget:g} s bought no row of {', '.join(found.lacking)}: about {found.needed:g} s would "
        "buy each variant one"
    )


def _show_front(found: Chart) -> None:
    for variant, words in found.outside:
        say(f"{variant} leaves the range of its kinematics: {words}.")
    rows: list[tuple[Any, ...]] = [
        (r.variant, r.setting, (r.seconds or 0.0) * 1e3, r.error, r.step_error) for r in found.front
    ]
    for peer in found.peers:
        at = peer.setting if peer.failure is None else peer.failure
        rows.append((peer.peer, at, None if peer.seconds is None else peer.seconds * 1e3, peer.error, None))
    caption = (
        f"{len(found.measured)} settings measured, {len(found.failed)} without a result (see --json). "
        f"Errors are from physics, {found.reference.how}, known to "
        f"{measured(found.reference.uncertainty, found.unit)}."
    )
    head = ("variant", "method", "ms per simulated s", f"error [{found.unit}]", f"of it by the step [{found.unit}]")
    show(f"{found.scene}, the Pareto fronts", head, rows, caption=caption)


def choose(
    scene: SceneName,
    settings: Settings = None,
    tolerance: Annotated[float | None, typer.Option(help="Largest error, SI; the scene's own if not given.")] = None,
    plot: Picture = None,
    budget: Budget = 15.0,
    lanes: Annotated[
        int, typer.Option(help="Motions at once: also the fastest setting of the stepper for so many.")
    ] = 1,
    as_json: AsJson = False,
) -> None:
    """Find the smallest model that a scene needs. Exit code 1 where none is shown to be good enough.

    The picture of --plot is the chart, measured within the budget, with the chosen model and method ringed.
    """
    chosen = with_settings(scene, settings or [])
    drawable(plot)
    motions = Motions(chosen)
    with bar(f"choose {chosen.name}") as tell:
        charted = None
        if plot is not None:
            charted = measure(chosen, budget=budget, motions=motions, progress=share(tell, 0.0, 0.6))
        own = share(tell, 0.6, 1.0) if plot is not None else tell
        found = climb(chosen, tolerance, measured=charted, motions=motions, lanes=lanes, progress=own)
    if plot is not None and charted is not None:
        save_chart(charted.holding(found.integrator), plot, mark=found.integrator)
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

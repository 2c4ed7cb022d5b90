"""`pliant report` and `pliant figures`: folders of pictures and tables."""

from __future__ import annotations

import glob
import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from pliant.envs.scene_files.settings import with_settings
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_choice
from pliant.studies.papers import registry
from pliant.studies.report.comparison import compare_reports
from pliant.studies.report.report import report as write

from .console import bar, writable_folder
from .options import AsJson, SceneName, Settings


def report(
    scene: SceneName,
    other: Annotated[str | None, typer.Argument(help="Another scene, to be compared with it.")] = None,
    settings: Settings = None,
    versus: Annotated[
        list[str] | None,
        typer.Option("--versus", metavar="NAME=VALUE", help="Compare with this setting besides: --set of the other."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write; reports/SCENE if not given.")] = None,
    budget: Annotated[
        float | None, typer.Option(help="Processor time of the chart in s; if not given as time allows.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Everything about one scene in one folder: report.html, the pictures, the tables; or about two, side by side."""
    chosen = with_settings(scene, settings or [])
    if other is not None or versus:
        changed = versus or []
        kept = [each for each in settings or [] if each.partition("=")[0] not in {v.partition("=")[0] for v in changed}]
        _two(chosen, with_settings(other or scene, [*kept, *changed]), changed, out, budget, as_json)
        return
    folder = Path("reports") / chosen.name if out is None else out
    writable_folder("--out", folder)
    with bar(f"report {chosen.name}") as tell:
        page = write(chosen, folder, progress=tell, budget=budget)
    told = (folder / "report.json").read_text(encoding="utf-8")
    for name, reason in json.loads(told)["lost"].items():
        print(f"not found: {name}: {' '.join(reason.split())}", file=sys.stderr)
    if as_json:
        print(told, end="")
    else:
        print(page)


def _two(
    first: Scene, second: Scene, changed: list[str], out: Path | None, budget: float | None, as_json: bool
) -> None:
    """Both reports and the page that compares them."""
    labels = (first.name, ", ".join([second.name, *changed]))
    folder = Path("reports") / f"{first.name}-and-{second.name}" if out is None else out
    writable_folder("--out", folder)
    with bar(f"report {labels[0]} and {labels[1]}") as tell:
        page = compare_reports(first, second, folder, labels=labels, progress=tell, budget=budget)
    print((folder / "report.json").read_text(encoding="utf-8") if as_json else page, end="" if as_json else "\n")


def open_report(
    scene: Annotated[str | None, typer.Argument(help="Of this scene; the newest if not given.")] = None,
    show: Annotated[bool, typer.Option("--show", help="Open it in the browser as well.")] = False,
) -> None:
    """Print where the last report of this folder is, reports/*/report.html; --show opens it."""
    wanted = "*" if scene is None else glob.escape(scene)
    found = sorted(Path("reports").glob(f"{wanted}/report.html"), key=_age)
    if not found:
        raise ValueError(f"open: no reports/{scene or '*'}/report.html here: write one by `pliant report`")
    print(found[-1])
    if show:
        typer.launch(str(found[-1].resolve()))


def _age(path: Path) -> float:
    return path.stat().st_mtime


def figures(
    paper: Annotated[str, typer.Argument(help="single-link, large-beam or slider-crank.")],
    out: Annotated[Path | None, typer.Option(help="Folder to write; figures/PAPER if not given.")] = None,
) -> None:
    """Draw the figures of the paper that a plant comes from."""
    require_choice("figures", "paper", paper, tuple(registry.PAPERS))
    folder = Path("figures") / paper if out is None else out
    writable_folder("--out", folder)
    with bar(f"figures {paper}") as tell:
        files = registry.write(paper, folder, tell)
    print("\n".join(map(str, files)))

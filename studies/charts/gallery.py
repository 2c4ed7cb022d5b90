"""Charts of many scenes in one folder, with a page that shows them all; what is there already is not measured again."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from pliant.envs import scenes as shipped
from pliant.plants import PliantError
from pliant.plants.core.argument_gates import require_function, require_names, require_path, require_seconds
from pliant.plants.files.atomic_files import write_text
from pliant.studies.common import machine
from pliant.studies.common.formatting import measured, paragraph, table
from pliant.studies.common.html_page import document, section
from pliant.studies.common.reference_motions import Progress, share
from pliant.studies.fidelity.speed_accuracy import Chart

from .measure import Peers, chart, programs
from .page import save_all, sentence

KEPT = ".rows.jsonl"  # beside a scene's page: the rows, as they were measured
INDEX = "index.html"


def gallery(
    out: str | Path,
    *,
    scenes: Sequence[str] | None = None,
    budget: float = 15.0,
    peers: bool | Peers = False,
    progress: Progress | None = None,
) -> tuple[Chart, ...]:
    """A page, a picture and a table of each scene (None: all that are shipped) in the folder `out`, and its index.html.

    A scene whose table was made there with at least this budget, by this version on this machine, is taken as it is; a
    run that was killed goes on with the rows that it kept. A scene that cannot be charted stands in the index with the
    reason. Returns the charts.

    Example
    -------
    >>> found = gallery("charts", scenes=("single-link-slew",), budget=0.5)
    >>> [chart.scene for chart in found]
    ['single-link-slew']
    """
    folder = require_path("gallery.out", out)
    names = require_names("gallery.scenes", tuple(shipped.SCENES) if scenes is None else scenes, tuple(shipped.SCENES))
    budget = require_seconds("gallery.budget", budget)
    wanted = programs("gallery.peers", peers)
    if progress is not None:
        require_function("gallery.progress", progress)
    folder.mkdir(parents=True, exist_ok=True)
    found: list[Chart] = []
    failed: list[tuple[str, str]] = []
    for i, name in enumerate(names):
        own = share(progress, i / len(names), (i + 1) / len(names))
        done = _made_before(folder / f"{name}.json", budget, wanted is not None)
        if done is None:
            scene = shipped.get(name)
            try:
                kept = folder / f"{name}{KEPT}"
                done = chart(scene, budget=budget, kept=kept, peers=peers, progress=_named(name, own))
            except PliantError as reason:
                failed.append((name, f"{type(reason).__name__}: {reason}"))
                continue
            save_all(done, folder, about=scene.about)
        found.append(done)
        write_text(folder / INDEX, index(found, failed))
    write_text(folder / INDEX, index(found, failed))
    return tuple(found)


def _named(name: str, progress: Progress) -> Progress:
    return lambda fraction, task: progress(fraction, f"{name}: {task}")


def _made_before(path: Path, budget: float, peers: bool) -> Chart | None:
    """The chart of a table that need not be made again."""
    try:
        found = Chart.from_json(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    same = found.machine == machine.describe()
    return found if same and found.budget >= budget and (found.peers or not peers) else None


def index(charts: Sequence[Chart], failed: Sequence[tuple[str, str]] = ()) -> str:
    """The page that shows them all."""
    cards = "".join(
        f'<figure><a href="{escape(c.scene)}.html"><img src="{escape(c.scene)}.png" alt="speed against accuracy of '
        f'{escape(c.scene)}"></a><figcaption><strong>{escape(c.scene)}</strong>. {escape(sentence(c))}'
        "</figcaption></figure>\n"
        for c in charts
    )
    body = f'<div class="gallery">{cards}</div>'
    body += "".join(paragraph(f"{name}: {why}", "warning") for name, why in failed)
    head = (
        "scene",
        "variants",
        "methods",
        "measured",
        "failed",
        "not run",
        "physics is known to",
        "over the best error",
    )
    main = section("Every scene", body) + section("In numbers", table(head, [counted(c) for c in charts]))
    described = charts[0].machine if charts else machine.describe()
    main += section("Machine", table(("what", "value"), list(described.items())))
    top = "<h1>Speed against accuracy</h1><p>Every shipped scene; a picture leads to its page.</p>"
    return document("Speed against accuracy", top, main, f"Made by Pliant {escape(described['pliant'])}.")


def counted(chart: Chart) -> tuple[Any, ...]:
    """A chart in numbers: what it holds, and how far the reference is known beside the best error measured."""
    not_run = sum(r.reason.endswith("not run") for r in chart.failed)
    errors = [r.error for r in chart.measured if r.error]
    known = chart.reference.uncertainty
    methods = {r.method for r in chart.measured if r.path != "linear"}
    return (
        chart.scene,
        len(chart.variants),
        len(methods),
        len(chart.measured),
        len(chart.failed) - not_run,
        not_run,
        measured(known, chart.unit),
        known / min(errors) if errors else None,
    )

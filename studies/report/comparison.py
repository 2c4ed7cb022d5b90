"""Two reports side by side: of two scenes, or of one scene with other settings."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_instance, require_path, require_seconds
from pliant.plants.files.atomic_files import write_text
from pliant.studies.common import atomic_files
from pliant.studies.common.formatting import paragraph, table
from pliant.studies.common.html_page import document, section
from pliant.studies.common.reference_motions import Progress, share

from .report import report

SIDE_BY_SIDE = ("motion", "controllers", "stability", "speed_accuracy")  # pictures
STYLE = (
    "<style>.two { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; } .two img { background: #fff; }</style>"
)


def compare_reports(
    first: Scene,
    second: Scene,
    out: str | Path,
    *,
    labels: tuple[str, str] | None = None,
    progress: Progress | None = None,
    budget: float | None = None,
) -> Path:
    """Write both reports, out/first and out/second, and out/report.html, in which their answers stand side by side.

    labels: what the two are called; their names where they are not given. The folder appears whole or not at all.
    `budget` [s] as of `report`. Returns the page's path; ValueError where `out` holds other files.
    """
    for name, scene in (("first", first), ("second", second)):
        require_instance(f"compare_reports.{name}", scene, Scene)
    out = require_path("compare_reports.out", out)
    budget = None if budget is None else require_seconds("compare_reports.budget", budget)
    atomic_files.check_target(out)
    called = labels or (first.name, second.name)
    with atomic_files.whole_folder(out) as folder:
        for k, (name, scene) in enumerate((("first", first), ("second", second))):
            report(scene, folder / name, progress=share(progress, k / 2, (k + 1) / 2), budget=budget)
        told = [json.loads((folder / name / atomic_files.MARK).read_text("utf-8")) for name in ("first", "second")]
        write_text(folder / "report.html", _page(folder, called, [dict(one["answer"]) for one in told]))
        files = sorted([p.name for p in folder.iterdir()] + [atomic_files.MARK])
        atomic_files.write_json(
            folder / atomic_files.MARK, {"compared": called, "answers": [one["answer"] for one in told], "files": files}
        )
    return out / "report.html"


def _page(folder: Path, called: tuple[str, str], answers: list[dict[str, str]]) -> str:
    """The answers in two columns, those that differ marked, and the pictures that both have."""
    names = list(dict.fromkeys([*answers[0], *answers[1]]))
    rows = [(name, answers[0].get(name, "–"), answers[1].get(name, "–")) for name in names]
    differ = [i for i, (_, one, other) in enumerate(rows) if one != other]
    body = section("The answers", table(("what", *called), rows, marked=differ) + _links(called))
    for picture in SIDE_BY_SIDE:
        both = [f"{name}/{picture}.png" for name in ("first", "second")]
        if all((folder / path).is_file() for path in both):
            drawn = "".join(
                f'<figure><a href="{path}"><img src="{path}" alt="{escape(label)}" width="100%"></a></figure>'
                for path, label in zip(both, called, strict=True)
            )
            body += section(picture.replace("_", " ").capitalize(), f'<div class="two">{drawn}</div>')
    head = f"<h1>{escape(called[0])} and {escape(called[1])}</h1>"
    return document(f"{called[0]} and {called[1]}", STYLE + head, body, "Made by Pliant.")


def _links(called: tuple[str, str]) -> str:
    links = " and ".join(
        f'<a href="{name}/report.html">{escape(label)}</a>'
        for name, label in zip(("first", "second"), called, strict=True)
    )
    return paragraph("Marked is what differs.") + f"<p>The whole reports: {links}.</p>\n"

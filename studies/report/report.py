"""One scene, everything: motion, linear models, stability, controllers in closed loop, chart, choice of a model."""

from __future__ import annotations

import time as clock
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_function, require_instance, require_path, require_seconds
from pliant.plants.files.atomic_files import write_text
from pliant.studies.common import atomic_files
from pliant.studies.common.reference_motions import Progress, share
from pliant.studies.figures import style

from . import answer, json_tables, page
from .pictures import figures_of
from .study import study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def report(scene: Scene, out: str | Path, *, progress: Progress | None = None, budget: float | None = None) -> Path:
    """Write the folder `out`: report.html, the figures as png, the tables as json. Returns the html's path.

    The folder appears whole or not at all; a former report is replaced. A part that cannot be found, such as a linear
    model of a goal that the plant cannot reach, is told in its place, and in report.json under "lost". `budget` [s] is
    the chart's (None: as time allows). ValueError where `out` holds other files.
    """
    require_instance("report.scene", scene, Scene)
    out = require_path("report.out", out)
    budget = None if budget is None else require_seconds("report.budget", budget)
    if progress is not None:
        require_function("report.progress", progress)
    atomic_files.check_target(out)
    began = clock.perf_counter()
    found = study(scene, progress=share(progress, 0.0, 0.85), budget=budget)
    told = share(progress, 0.85, 1.0)
    with atomic_files.whole_folder(out) as folder:
        told(0.0, "figures")
        inlined = dict[str, str]()
        drawn = figures_of(found)
        for i, (name, figure) in enumerate(drawn.items()):
            told(0.6 * i / len(drawn), f"figure {name}")
            text = found.attempt(f"figure {name}", partial(_drawn, figure, folder / f"{name}.png"))
            if text is not None:
                inlined[name] = text
        for name, table in json_tables.tables_of(found).items():
            atomic_files.write_json(folder / f"{name}.json", table)
        found.attempt("open_loop.npz", lambda: found.open_loop.save(folder / "open_loop.npz"))
        told(0.7, "page")
        found.seconds = clock.perf_counter() - began
        write_text(folder / "report.html", page.build(found, inlined))
        contents = sorted([p.name for p in folder.iterdir()] + [atomic_files.MARK])
        atomic_files.write_json(
            folder / atomic_files.MARK,
            {
                "scene": scene.name,
                "plant": scene.plant.label,
                "seconds": found.seconds,
                "machine": found.machine,
                "files": contents,
                "lost": found.lost,
                "answer": answer.rows(found),
            },
        )
    told(1.0, "report")
    return out / "report.html"


def _drawn(figure: Figure, path: Path) -> str:
    """A picture as a file, and as the text that goes into the page."""
    style.save(figure, path)
    return style.inline(figure)

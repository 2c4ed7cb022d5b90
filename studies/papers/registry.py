"""The figures of the papers that the plants come from, each by one command: `pliant figures single-link`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from pliant.plants.core.argument_gates import require_choice, require_function, require_path
from pliant.plants.files.whole_folders import renewed
from pliant.studies.common.reference_motions import Progress
from pliant.studies.figures.style import save

from . import large_beam, single_link, slider_crank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAPERS = {
    "single-link": "On the dynamic modelling of flexible manipulators: Figures 3 to 5",
    "large-beam": "Substructuring Technique for Dynamics Analysis of Flexible Beams: Figures 3 and 4",
    "slider-crank": "Elastodynamic Analysis of a Mechanism with Flexible Links: Figures 6 to 10, and unstable tongues",
}


def _slider_crank() -> dict[str, Figure]:
    return {**slider_crank.figures(), "tongues": slider_crank.tongues()}


DRAWN: Mapping[str, Callable[[], dict[str, Figure]]] = {
    "single-link": single_link.figures,
    "large-beam": large_beam.figures,
    "slider-crank": _slider_crank,
}


def draw(paper: str) -> dict[str, Figure]:
    """The figures of one of PAPERS, by file name."""
    require_choice("figures", "paper", paper, tuple(PAPERS))
    return DRAWN[paper]()


def write(paper: str, folder: Path, progress: Progress) -> list[Path]:
    """Draw the figures as png files into a folder, made if missing; returns the files.

    All take their places at once when all are drawn. OSError, which names the file.
    """
    require_choice("figures", "paper", paper, tuple(PAPERS))
    folder = require_path("figures.folder", folder)
    require_function("figures.progress", progress)(0.1, f"figures of {paper}")
    found = draw(paper)
    with renewed(folder) as made:
        for k, (name, figure) in enumerate(found.items()):
            save(figure, made / f"{name}.png")
            progress(0.9 + 0.1 * (k + 1) / len(found), name)
    return [folder / f"{name}.png" for name in found]

"""The figures of the papers that the plants come from, each by one command: `pliant figures single-link`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from pliant.plants.core.parameters import require_choice

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pliant.studies.common.reference_motions import Progress

PAPERS = {
    "single-link": "On the dynamic modelling of flexible manipulators: Figures 3 to 5",
    "large-beam": "Substructuring Technique for Dynamics Analysis of Flexible Beams: Figures 3 and 4",
    "slider-crank": "Elastodynamic Analysis of a Mechanism with Flexible Links: Figures 6 to 10, and unstable tongues",
}


def draw(paper: str) -> dict[str, Figure]:
    """The figures of one of PAPERS, by file name."""
    require_choice("figures", "paper", paper, tuple(PAPERS))
    if paper == "single-link":
        from .single_link import figures

        return figures()
    if paper == "large-beam":
        from .large_beam import figures

        return figures()
    from .slider_crank import figures, tongues

    return {**figures(), "tongues": tongues()}


def write(paper: str, folder: Path, progress: Progress) -> list[Path]:
    """Draw the figures as png files into a folder, made if missing; returns the files."""
    from pliant.studies.figures.style import save

    progress(0.1, f"figures of {paper}")
    found = draw(paper)
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for k, (name, figure) in enumerate(found.items()):
        files.append(folder / f"{name}.png")
        save(figure, files[-1])
        progress(0.9 + 0.1 * (k + 1) / len(found), name)
    return files

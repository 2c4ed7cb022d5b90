"""How the pictures look: one style, saved as png on white or inlined as svg in the page's own text colour.

matplotlib is imported where something is drawn, here and in the modules beside: the commands start without it.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from pliant.plants.core.argument_gates import require_path
from pliant.plants.files.atomic_files import Together, replacing
from pliant.studies.common.compact_svg import compact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK = "#20242a"  # text and lines; in the page it takes the page's text colour
QUIET = "#8a9099"
COLOURS = (  # told apart by eyes that lack red, green or blue cones, on white and on black; see tests/studies/figures
    "#3b7dd8",
    "#e07b39",
    "#0e7a55",
    "#8e2f7a",
    "#5a32b8",
    "#e0b400",
    "#45c3d0",
    "#c4384e",
    "#4f5d14",
    "#9d8f86",
)
MARKERS = ("o", "s", "^", "D", "P", "X", "v")
WIDTH = 8.0  # [in]
DPI = 150

RC: Any = {
    "font.size": 9.0,
    "font.family": "sans-serif",
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.facecolor": "none",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": QUIET,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "lines.linewidth": 1.4,
    "lines.markersize": 5.0,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "figure.facecolor": "none",
    "svg.fonttype": "none",
    "svg.hashsalt": "pliant",
    "axes.prop_cycle": f"cycler('color', {list(COLOURS)})",
}

P = ParamSpec("P")
F = TypeVar("F")  # a figure, or None where there is nothing to draw


def styled(draw: Callable[P, F]) -> Callable[P, F]:
    """A function that draws in this style, whatever the caller's own settings are."""

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> F:
        import matplotlib

        with matplotlib.rc_context(RC):
            return draw(*args, **kwargs)

    return drawn


def panels(
    rows: int, columns: int = 1, *, height: float = 2.2, width: float = WIDTH, **options: Any
) -> tuple[Figure, list[Axes]]:
    """A figure of rows x columns panels, each row `height` [in] high, and its axes row by row."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    return figure, list(axes.flat)


def require_ending(name: str, path: Path) -> str:
    """The format that a picture's ending names, "png" or "svg"; ValueError where matplotlib knows none of the name."""
    from matplotlib.backend_bases import FigureCanvasBase

    ending, known = path.suffix.lower().lstrip("."), sorted(FigureCanvasBase.get_supported_filetypes())
    if ending not in known:
        raise ValueError(f"{name} {str(path)!r} must end with one of {', '.join(known)}")
    return ending


def save(figure: Figure, path: str | Path, together: Together | None = None) -> None:
    """Write the figure on white, as its ending says (png, svg, pdf): whole, or as the file was before.

    together: the files that take their places at once, of which this is one. ValueError for an unknown ending;
    OSError, which names the file, where it cannot be written.
    """
    import matplotlib

    path = require_path("save.path", path)
    ending = require_ending("picture", path)
    writing = replacing(path) if together is None else together.file(path)
    with matplotlib.rc_context(RC), writing as file:
        if ending == "png":
            _png(figure, file)
        else:
            figure.savefig(file, format=ending, dpi=DPI, facecolor="white")
    figure.set_layout_engine("none")  # done


def _png(figure: Figure, file: Any) -> None:
    """What savefig writes, drawn once: it draws a figure twice, the first time for its layout alone."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    before = figure.dpi, figure.get_facecolor()
    figure.set_dpi(DPI)
    figure.set_facecolor("white")
    FigureCanvasAgg(figure).print_png(file)
    figure.set_dpi(before[0])
    figure.set_facecolor(before[1])


def inline(figure: Figure) -> str:
    """The figure as an svg element for a page: no links, its ink in the page's text colour.

    A figure that has been saved keeps the layout that it got there, which takes most of the drawing's time.
    """
    import matplotlib

    buffer = io.StringIO()
    with matplotlib.rc_context(RC):
        figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r' xmlns(:\w+)?="[^"]*"', "", text)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*" height="[^"]*"|(<svg[^>]*?) height="[^"]*" width="[^"]*"', _bare, text)
    return compact(text.replace(INK, "currentColor").replace("xlink:href", "href"))


def _bare(match: re.Match[str]) -> str:
    """Only the viewBox is left, so that the page sets the size."""
    return match.group(1) or match.group(2)

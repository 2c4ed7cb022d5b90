"""The picture of the speed-accuracy chart: one lane beside 1,024, and below it what failed and why.

Colour     the variant: a hue for each kinematics, from light to dark as the ladder climbs
Marker     the method; a rim where the stepper played it, hollow in single precision
Band       errors below ten times what the reference is known to: not told apart from it, arrows that point down
Line       the Pareto front of its panel; linear models at hand stand apart from it
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pliant.plants.files.atomic_files import Together
from pliant.studies.common.formatting import measured
from pliant.studies.fidelity.speed_accuracy import LANES, Chart, Row

from . import style
from .failure_strip import draw_failures, strip_height
from .style import COLOURS, INK, QUIET, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

RAMPS = (("#8fc1f0", "#123f7d"), ("#f7b35c", "#a84a00"), ("#7ee0d8", "#00595a"), ("#e58fc6", "#6b0049"))
METHOD_MARKERS = {
    "dop853": "o",
    "rk4": "s",
    "rk8": "^",
    "rosenbrock": "D",
    "rodas5p": "d",
    "midpoint": "P",
    "cvodes": "X",
    "ltv": "*",
    "linear": "h",
    "reduced": "p",
}
METHOD_NAMES = {"ltv": "LTV along a motion", "linear": "linear, about the start", "reduced": "linear, half the states"}
PEER_MARKERS = ("v", "<", ">", "8", "1", "2", "3", "4")
PEER = "#6a6f76"
FEW_DECADES = 60.0  # times: axes that are shorter have more labels
WIDTH, HEIGHT = 11.0, 4.4  # [in], of the panels
FAR = 1e3  # times the tolerance: errors beyond stand at the edge
BELOW = 2.0  # times: how far below what is told the arrows of the others stand
UNTOLD = 11  # Matplotlib's caret that points down from its place
LEGEND = 0.165  # [in] of a line of the legend
LONGEST_TITLE = 85  # characters of a line


@styled
def speed_accuracy(chart: Chart, mark: Row | None = None) -> Figure:
    """Error against time a simulated second and lane, with the fronts; `mark`: a row that is ringed as the chosen one.

    Measured rows have the ids row-0, row-1, .. of their places in `chart.rows`, peers peer-0, .. and failures fail-..
    """
    from matplotlib.figure import Figure

    colours, (low, high) = variant_colours(chart.variants), _range(chart)
    below, handles = strip_height(chart), _legend(chart, colours, low, mark)
    above = max(HEIGHT, LEGEND * (len(handles) + 2) - below)
    figure = Figure(figsize=(WIDTH, above + below), layout="constrained")
    layout: Any = [["one", "many"], ["strip", "strip"]] if below else [["one", "many"]]
    ratios = [above, below] if below else [above]
    axes = figure.subplot_mosaic(layout, height_ratios=ratios, width_ratios=[1.25, 1.0])
    for ax, lanes in zip((axes["one"], axes["many"]), LANES):
        _panel(ax, chart, lanes, colours, (low, high), mark)
    beyond = (
        f"\nfrom {high:g} {chart.unit} on at the edge" if any((r.error or 0.0) > high for r in chart.measured) else ""
    )
    axes["one"].set_ylabel(f"largest error of {', '.join(chart.compare)} [{chart.unit}]{beyond}")
    axes["many"].tick_params(labelleft=False)
    if below:
        draw_failures(axes["strip"], chart, colours, METHOD_MARKERS)
    figure.suptitle(_title(chart), x=0.01, ha="left", fontsize=10.0, fontweight="bold")
    figure.legend(handles=handles, loc="outside right upper", handlelength=1.4)
    return figure


def save(chart: Chart, path: str | Path, together: Together | None = None, mark: Row | None = None) -> None:
    """Draw a chart into a file, as its ending says. Errors and `together` as `style.save`."""
    style.save(speed_accuracy(chart, mark), path, together)


def variant_colours(labels: Sequence[str]) -> dict[str, str]:
    """A colour for each variant: a hue for each word before the first comma, light to dark in the ladder's order.

    A family of one that comes first, as the rigid plant, is drawn in ink.
    """
    families: dict[str, list[str]] = {}
    for label in labels:
        families.setdefault(label.partition(",")[0], []).append(label)
    found: dict[str, str] = {}
    left = list(RAMPS)
    for k, members in enumerate(families.values()):
        if k == 0 and len(members) == 1 and len(families) > 1:
            found[members[0]] = INK
            continue
        light, dark = left[0]
        left = [*left[1:], left[0]]
        for i, label in enumerate(members):
            share = i / (len(members) - 1) if len(members) > 1 else 0.5
            found[label] = _between(light, dark, share)
    return found


def _between(light: str, dark: str, share: float) -> str:
    """A colour on the way, in hexadecimal."""
    ends = [[int(text[i : i + 2], 16) for i in (1, 3, 5)] for text in (light, dark)]
    return "#" + "".join(f"{round(a + share * (b - a)):02x}" for a, b in zip(*ends))


def _range(chart: Chart) -> tuple[float, float]:
    """Errors that the picture goes from and to; those beyond stand at the edge."""
    band = chart.told_from
    told = [*(row.error for row in chart.measured), *(peer.error for peer in chart.peers)]
    errors = [error for error in told if error]
    lowest = max(min(errors, default=chart.tolerance), band / BELOW, 1e-9 * chart.tolerance)
    highest = min(max([*errors, 3 * chart.tolerance]), FAR * chart.tolerance)
    return lowest, highest


def _panel(
    ax: Axes, chart: Chart, lanes: int, colours: dict[str, str], ends: tuple[float, float], mark: Row | None
) -> None:
    low, high = ends
    ax.set(xscale="log", yscale="log", ylim=(low / 1.8, high * 1.8))
    if chart.told_from > low / 1.8:
        ax.axhspan(low / 2, chart.told_from, color=QUIET, alpha=0.22, lw=0, zorder=0)
    ax.axhline(chart.tolerance, color=COLOURS[7], lw=1.2, ls="--", zorder=1)
    front = []
    for i, row in enumerate(chart.rows):
        if row.failure is not None or row.lanes != lanes:
            continue
        at = (row.seconds or 0.0) * 1e3, _height(chart, row.error or 0.0, ends)
        look = marker(row, colours[row.variant])
        if (row.error or 0.0) < chart.told_from:
            look |= {"marker": UNTOLD, "ms": 6.5}
        ax.plot(*at, **look, gid=f"row-{i}")
        if row.pareto:
            front.append(at)
        if mark is not None and row.key == mark.key:
            ax.plot(*at, "o", ms=14, mfc="none", mec=INK, mew=1.6, ls="none", zorder=5, gid="marked")
    if front:
        ax.step(*zip(*sorted(front)), where="post", color=INK, lw=1.1, zorder=1)
    if lanes == 1:
        ax.set_title("one motion", fontweight="normal")
        _draw_peers(ax, chart, ends)
    else:
        ax.set_title(f"{lanes:,} motions at once, one thread", fontweight="normal")
        if not front:
            ax.text(0.5, 0.5, "none measured", transform=ax.transAxes, ha="center", color=QUIET)
            ax.set_xlim(1e-3, 1.0)
    ax.set_xlabel("wall time per simulated second [ms]" if lanes == 1 else "the same, per motion [ms]")
    _readable(ax.xaxis)
    _readable(ax.yaxis)


def _height(chart: Chart, error: float, ends: tuple[float, float]) -> float:
    """Where an error is drawn: all that are not told apart from physics as high as each other."""
    low, high = ends
    return chart.told_from / BELOW**0.5 if error < chart.told_from else min(max(error, low), high)


def _draw_peers(ax: Axes, chart: Chart, ends: tuple[float, float]) -> None:
    """Markers in grey, those of one program on a thin line."""
    lines: dict[str, list[tuple[float, float]]] = {}
    for i, peer in enumerate(chart.peers):
        if peer.failure is None and peer.seconds is not None and peer.error is not None:
            at = peer.seconds * 1e3, _height(chart, peer.error, ends)
            lines.setdefault(peer.peer, []).append(at)
            shape = UNTOLD if peer.error < chart.told_from else _peer_marker(chart, peer.peer)
            ax.plot(*at, marker=shape, color=PEER, ms=6, ls="none", gid=f"peer-{i}", zorder=2)
    for points in lines.values():
        ax.plot(*zip(*sorted(points)), color=PEER, lw=0.8, alpha=0.6, zorder=1)


def _readable(axis: Axis) -> None:
    """Labels at decades, or at 1, 2 and 5 of them where there are few; none in between."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    low, high = axis.get_view_interval()
    if high < FEW_DECADES * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def marker(row: Row, colour: str) -> dict[str, Any]:
    """How a row is drawn."""
    rim = INK if row.path == "stepper" and row.precision == "double" else colour
    return {
        "marker": METHOD_MARKERS.get(row.method, "o"),
        "color": colour,
        "mec": rim,
        "mfc": "none" if row.precision == "single" else colour,
        "mew": 1.0 if row.path == "stepper" else 0.6,
        "ms": 8.0 if row.method == "ltv" else 5.5,
        "ls": "none",
        "alpha": 1.0 if row.pareto else 0.75,
        "zorder": 4 if row.pareto else 3,
    }


def _peer_marker(chart: Chart, name: str) -> str:
    names = list(dict.fromkeys(peer.peer for peer in chart.peers))
    return PEER_MARKERS[names.index(name) % len(PEER_MARKERS)]


def _title(chart: Chart) -> str:
    known = measured(chart.reference.uncertainty, chart.unit)
    what = f"{chart.scene}: speed against accuracy"
    told = f"errors from physics, {chart.reference.variant}, known to {known}"
    if len(what) + len(told) < LONGEST_TITLE:
        return f"{what}; {told}"
    return "\n".join([what, *textwrap.wrap(told, LONGEST_TITLE)])


def _legend(chart: Chart, colours: dict[str, str], low: float, mark: Row | None) -> list[Any]:
    """Only what is drawn, in the panels or the strip."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    def entry(label: str, shape: str | int = "", **look: Any) -> Line2D:
        return Line2D([], [], **{"marker": shape, "ls": "none", "color": QUIET, "label": label, **look})

    rows = chart.measured
    handles: list[Any] = [entry(variant, "o", color=colour) for variant, colour in colours.items()]
    methods = [m for m in METHOD_MARKERS if any(r.method == m for r in chart.rows if not r.reason.endswith("not run"))]
    handles += [entry(METHOD_NAMES.get(m, m), METHOD_MARKERS[m], ms=7 if m == "ltv" else 5.5) for m in methods]
    if any(r.path == "stepper" and r.precision == "double" for r in rows):
        handles.append(entry("by the stepper", "o", mec=INK, mew=1.1))
    if any(r.precision == "single" for r in rows):
        handles.append(entry("by it in single precision", "o", mfc="none", mew=1.1))
    for name in dict.fromkeys(peer.peer for peer in chart.peers if peer.failure is None):
        handles.append(entry(name, _peer_marker(chart, name), color=PEER, ms=6))
    if any(r.pareto for r in rows):
        handles.append(Line2D([], [], color=INK, lw=1.1, label="Pareto front"))
    if mark is not None:
        handles.append(entry("chosen", "o", ms=10, mfc="none", mec=INK, mew=1.6))
    tolerance = f"tolerance, {measured(chart.tolerance, chart.unit)}"
    handles.append(Line2D([], [], color=COLOURS[7], lw=1.2, ls="--", label=tolerance))
    if chart.told_from > low / 1.8:
        errors = [r.error for r in rows] + [p.error for p in chart.peers if p.failure is None]
        if any((error or 0.0) < chart.told_from for error in errors):
            handles.append(entry("not told apart from physics", UNTOLD, ms=6.5))
        label = f"below ten times what physics\nis known to, {measured(chart.told_from, chart.unit)}"
        handles.append(Patch(color=QUIET, alpha=0.22, lw=0, label=label))
    return handles

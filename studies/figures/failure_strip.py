"""The strip below a speed-accuracy chart: what has no result, grouped by its reason, counted.

Each variant and method that failed for a reason stands in its line once; what was merely not run is counted alone.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING

from pliant.studies.fidelity.speed_accuracy import Chart, Row

from .style import INK, QUIET

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINE, EDGE = 0.19, 0.42  # [in] of a line, and of the strip's title and edges
LETTERS = 118  # of a line of text
MARKS = 62  # of a line of markers
WORDS = {"dominated, not run": "that cannot be on the front", "no time left, not run": "for want of time"}
LEFT = 0.25  # share of the strip's width before the markers


def groups(chart: Chart) -> dict[str, list[int]]:
    """{reason: places in chart.rows} of what failed, the most frequent first; not of what was merely not run."""
    found: dict[str, list[int]] = {}
    for i, row in enumerate(chart.rows):
        if row.failure is not None and not row.reason.endswith("not run"):
            found.setdefault(row.reason, []).append(i)
    return dict(sorted(found.items(), key=lambda item: -len(item[1])))


def sentences(chart: Chart) -> list[str]:
    """What else has no result: settings not run, and other programs with their reasons."""
    counts: dict[str, int] = {}
    for row in chart.failed:
        if row.reason.endswith("not run"):
            counts[row.reason] = counts.get(row.reason, 0) + 1
    told = []
    if counts:
        each = " and ".join(f"{n} {_settings(n)} {WORDS[reason]}" for reason, n in counts.items())
        told.append(f"Not run: {each}.")
    alike: dict[str, list[str]] = {}
    for peer in chart.peers:
        if peer.failure is not None:
            alike.setdefault(peer.failure, []).append(peer.peer)
    told += [f"{'; '.join(dict.fromkeys(names))}: {failure}" for failure, names in alike.items()]
    return [line for text in told for line in textwrap.wrap(text, LETTERS, subsequent_indent="    ")]


def _settings(n: int) -> str:
    return "setting" if n == 1 else "settings"


def strip_height(chart: Chart) -> float:
    """[in]; 0 where everything has a result."""
    lines = len(groups(chart)) + len(sentences(chart))
    return EDGE + LINE * lines if lines else 0.0


def draw_failures(ax: Axes, chart: Chart, colours: Mapping[str, str], markers: Mapping[str, str]) -> None:
    """One line a reason, its markers as in the panels; below, what was not run."""
    found, told = groups(chart), sentences(chart)
    ax.set(xlim=(0, 1), ylim=(len(found) + len(told) - 0.4, -0.6), xticks=[], yticks=[])
    ax.grid(visible=False)
    for side in ("left", "bottom"):
        ax.spines[side].set_visible(False)
    ax.set_title("Without a result", fontweight="normal")
    for y, (reason, places) in enumerate(found.items()):
        ax.text(0.0, y, f"{reason} ({len(places)})", va="center", color=INK, fontsize=8)
        first: dict[tuple[str, str], int] = {}
        for i in places:
            first.setdefault((chart.rows[i].variant, chart.rows[i].method), i)
        step = (1 - LEFT) / MARKS
        for k, i in enumerate(list(first.values())[:MARKS]):
            _mark(ax, LEFT + step * k, y, chart.rows[i], i, colours, markers)
        if len(first) > MARKS:
            ax.text(1.0, y, f"+ {len(first) - MARKS}", va="center", ha="left", color=QUIET, fontsize=8)
    for y, line in enumerate(told, len(found)):
        ax.text(0.0, y, line, va="center", color=QUIET, fontsize=8)


def _mark(
    ax: Axes, x: float, y: float, row: Row, place: int, colours: Mapping[str, str], markers: Mapping[str, str]
) -> None:
    shape = markers.get(row.method, "o")
    ax.plot(x, y, marker=shape, color=colours[row.variant], ms=5, ls="none", gid=f"fail-{place}", clip_on=False)

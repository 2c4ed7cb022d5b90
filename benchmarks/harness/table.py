"""The measurements as json, markdown and a bar chart."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from harness.sampling import RATE, SHARE, Row
from pliant.plants.files.atomic_files import write_text
from pliant.plants.files.whole_folders import renewed
from pliant.studies.figures import style

if TYPE_CHECKING:
    from harness.targets import Check

COLUMNS = (1, 64, 1024, 4096)  # environments at once
WIDE = {"physics": "Physics", "environments": "Environment"}  # groups with a column a size and a panel of the chart
OURS, THEIRS = style.COLOURS[0], style.COLOURS[1]


def number(value: float | None) -> str:
    """Three digits, with thousands set apart: 1,230,000 or 0.0123; "-" for None."""
    if value is None:
        return "-"
    if abs(value) >= 1000:
        digits = len(str(int(abs(value)))) - 3
        return f"{round(value, -digits):,.0f}"
    return f"{value:.3g}"


def duration(seconds: float | None) -> str:
    """Seconds in the unit that suits: 4.1 us, 12.3 ms, 2.5 s."""
    if seconds is None:
        return "-"
    for unit, scale in (("us", 1e-6), ("ms", 1e-3)):
        if seconds < 999.5 * scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds:.3g} s"


def grid(head: Sequence[str], rows: Sequence[Sequence[str]], right: int) -> list[str]:
    """A markdown table; the columns from `right` on are set right."""
    marks = ["---:" if i >= right else "---" for i in range(len(head))]
    return [f"| {' | '.join(line)} |" for line in (head, marks, *rows)]


def rates(rows: Sequence[Row]) -> list[str]:
    """Steps a second: one line a name and thread count, one column a number of environments."""
    keys = dict.fromkeys((r.name, r.threads) for r in rows)
    lines = []
    for name, threads in keys:
        own = {r.lanes: r for r in rows if (r.name, r.threads) == (name, threads)}
        failures = sorted({r.failure for r in own.values() if r.failure})
        cells = [number(own[n].median) if n in own and not own[n].failure else "" for n in COLUMNS]
        lines.append([name + (f" ({'; '.join(failures)})" if failures else ""), str(threads), *cells])
    return grid(["", "threads", *(f"{n:,}" for n in COLUMNS)], lines, 1)


SHOW: dict[str, Callable[[float], str]] = {
    RATE: lambda v: f"{number(v)} steps/s",
    SHARE: lambda v: f"{100 * v:.1f} %",
    "FMA/s": lambda v: f"{v / 1e9:.1f} G/s",
}


def times(rows: Sequence[Row]) -> list[str]:
    """Median and range of each row, in its own unit."""
    lines = []
    for row in rows:
        show = SHOW.get(row.unit, duration)
        if row.failure:
            lines.append([row.name, str(row.threads), f"{row.lanes:,}", row.failure, ""])
        elif row.samples:
            cells = [show(row.median), f"{show(min(row.samples))} to {show(max(row.samples))}"]  # type: ignore[no-untyped-call]
            cells += [show(row.tail)] if row.tails else []  # type: ignore[no-untyped-call]
            lines.append([row.name, str(row.threads), f"{row.lanes:,}", *cells])
    head = ["", "threads", "environments or points", "median", "range"]
    if any(row.tails for row in rows):
        head.append("99th percentile of single calls")
        lines = [line + [""] * (len(head) - len(line)) for line in lines]
    return grid(head, lines, 1)


def verdicts(checks: Sequence[Check]) -> list[str]:
    """What was asked, what was measured and whether it holds."""
    words = {True: "yes", False: "**no**", None: "not measured"}
    lines = []
    for c in checks:
        bound = f"{'at least' if c.least else 'at most'} {number(c.asked)} {c.unit}".strip()
        measured = f"{number(c.measured)} {c.unit}".strip() if c.measured is not None else "-"
        lines.append([str(c.number), c.what, measured, bound, words[c.holds]])
    return grid(["", "what", "measured", "asked", "holds"], lines, 5)


def markdown(
    rows: Sequence[Row],
    checks: Sequence[Check],
    about: Mapping[str, str],
    notes: Sequence[str],
    own_tables: Mapping[str, Sequence[str]] | None = None,
) -> str:
    """The whole table; a group may have a table of its own."""
    groups = dict.fromkeys(r.group for r in rows)
    text = ["# Benchmarks", "", "Medians; every row sampled in turn, round after round, in one run.", ""]
    text += ["## Asked and measured", "", *verdicts(checks), ""]
    for group in groups:
        own = [r for r in rows if r.group == group]
        wide = group in WIDE
        title = f"{group.capitalize()}{', steps/s by the number of environments' if wide else ''}"
        given = (own_tables or {}).get(group)
        text += [f"## {title}", "", *(given or (rates(own) if wide else times(own))), ""]
    if notes:
        text += ["## Notes", "", *(f"- {note}" for note in notes), ""]
    text += ["## Machine", "", *grid(["", ""], [[k, v] for k, v in about.items()], 2), ""]
    return "\n".join(text)


def bars(rows: Sequence[Row], group: str) -> list[tuple[str, float, bool]]:
    """(label, steps/s, peer) of each name at its fastest, fastest first."""
    found: dict[str, Row] = {}
    for row in rows:
        if row.group != group or row.median is None or row.unit != RATE:
            continue
        if row.name not in found or row.median > (found[row.name].median or 0.0):
            found[row.name] = row
    ordered = sorted(found.values(), key=lambda r: -(r.median or 0.0))
    return [
        (
            f"{r.name}\n{r.lanes:,} at once, {r.threads} thread{'s' * (r.threads > 1)}",
            r.median or 0.0,
            r.peer and not r.name.startswith("Pliant"),
        )
        for r in ordered
    ]


@style.styled
def chart(found: Mapping[str, Sequence[tuple[str, float, bool]]]) -> Figure:
    """Horizontal bars on a logarithmic axis, one panel a title."""
    heights = [len(b) + 1.5 for b in found.values()]
    figure, axes = style.panels(len(found), height=0.34 * sum(heights) / len(found), height_ratios=heights)
    for axis, (title, own) in zip(axes, found.items()):
        labels, values, theirs = zip(*own)
        places = range(len(own))
        axis.barh(places, values, height=0.7, color=[THEIRS if peer else OURS for peer in theirs])
        axis.set_yticks(list(places), labels, fontsize=7)
        axis.invert_yaxis()
        axis.set_xscale("log")
        axis.set_xlim(min(values) / 3, max(values) * 4)
        axis.set_title(f"{title} steps a second, each at its fastest")
        axis.grid(axis="y", visible=False)
        for place, value in zip(places, values):
            label = {"xytext": (3, 0), "textcoords": "offset points", "va": "center", "fontsize": 7}
            axis.annotate(number(value), (value, place), **label)  # type: ignore[arg-type]
    axes[-1].set_xlabel("steps a second, logarithmic; blue: Pliant, orange: peers")
    return figure


def write(
    folder: Path,
    rows: Sequence[Row],
    checks: Sequence[Check],
    about: Mapping[str, str],
    notes: Sequence[str],
    extra: Mapping[str, Any],
    own_tables: Mapping[str, Sequence[str]] | None = None,
    figures: Mapping[str, Figure] | None = None,
) -> None:
    """benchmark.json, benchmark.md, benchmark.png and further figures by name."""
    content = {
        "about": dict(about),
        "checks": [asdict(c) | {"holds": c.holds} for c in checks],
        "rows": [asdict(r) | {"median": r.median} for r in rows],
        "notes": list(notes),
        **extra,
    }
    found = {title: b for group, title in WIDE.items() if (b := bars(rows, group))}
    with renewed(folder) as made:
        write_text(made / "benchmark.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
        write_text(made / "benchmark.md", markdown(rows, checks, about, notes, own_tables))
        if found:
            style.save(chart(found), made / "benchmark.png")
        for name, figure in (figures or {}).items():
            style.save(figure, made / f"{name}.png")

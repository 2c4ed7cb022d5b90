"""A chart as one self-contained HTML page, with the settings under the pointer; and as page, picture and table at once.

The markers of the picture carry ids (see `figures.speed_accuracy`); the page holds what is told of each by its id.
"""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import Any

from pliant.plants.files.atomic_files import Together
from pliant.studies.common.formatting import details, measured, number, paragraph, table
from pliant.studies.common.html_page import asset, document, section
from pliant.studies.fidelity.speed_accuracy import Chart, Row
from pliant.studies.figures import style
from pliant.studies.figures.speed_accuracy import speed_accuracy

ENDINGS = (".html", ".png", ".json")
MANY = 12  # settings of one marker that are named


def script() -> str:
    """What shows the settings under the pointer."""
    return asset(__package__ or "", "chart.js")


def interactive(chart: Chart, svg: str) -> str:
    """The picture with what is told of each marker."""
    packed = json.dumps(told(chart), separators=(",", ":")).replace("</", "<\\/")
    return (
        f'<div class="chart"><figure class="speed_accuracy">{svg}</figure><div class="tip" hidden></div>'
        f'<script type="application/json">{packed}</script></div>\n'
    )


def told(chart: Chart) -> dict[str, dict[str, Any]]:
    """{id of a marker: its variant and lines of text}."""
    found: dict[str, dict[str, Any]] = {}
    for i, row in enumerate(chart.rows):
        if row.failure is None:
            found[f"row-{i}"] = {"variant": row.variant, "lines": _lines(chart, row)}
        elif not row.reason.endswith("not run"):
            alike = [
                r for r in chart.failed if (r.variant, r.method, r.reason) == (row.variant, row.method, row.reason)
            ]
            settings = [r.setting for r in alike]
            more = [f"and {len(settings) - MANY} more"] if len(settings) > MANY else []
            lines = [f"{row.variant}, {row.method}", *settings[:MANY], *more, str(row.failure)]
            found[f"fail-{i}"] = {"variant": row.variant, "lines": lines}
    for i, peer in enumerate(chart.peers):
        if peer.failure is None:
            lines = [
                peer.peer,
                peer.setting,
                f"{number((peer.seconds or 0.0) * 1e3)} ms per simulated second",
                _error(chart, peer.error or 0.0),
                f"{peer.searched} settings searched",
            ]
            found[f"peer-{i}"] = {"variant": "", "lines": lines}
    return found


def _lines(chart: Chart, row: Row) -> list[str]:
    lines = [
        f"{row.variant} ({row.states} states)",
        row.setting,
        f"{number((row.seconds or 0.0) * 1e3)} ms per simulated second{' and lane' if row.lanes > 1 else ''}",
        _error(chart, row.error or 0.0),
    ]
    if row.step_error is not None:
        lines.append(f"{measured(row.step_error, chart.unit)} of it by the step")
    if row.made is not None:
        lines.append(f"the model took {number(row.made * 1e3)} ms per simulated second to make")
    if row.rms_bound is not None:
        lines.append(f"at most {measured(row.rms_bound, chart.unit)} rms from the linear model with all states")
    if row.native is False and row.path != "linear":
        lines.append("on the virtual machine")
    return [*lines, "on the Pareto front"] if row.pareto else lines


def _error(chart: Chart, error: float) -> str:
    """In words; one that is not told apart from physics as that."""
    if error < chart.told_from:
        return f"error below {measured(chart.told_from, chart.unit)}: not told apart from physics"
    return f"error {measured(error, chart.unit)}"


def sentence(chart: Chart) -> str:
    """What the chart comes to: the fastest within the tolerance, one motion and many."""
    said = []
    for lanes, words in ((1, "one motion"), (1024, "1,024 at once")):
        row = chart.fastest(lanes=lanes)
        if row is not None:
            speed = f"{number((row.seconds or 0.0) * 1e3)} ms per simulated second{' and motion' if lanes > 1 else ''}"
            said.append(f"{words}: {row.variant} by {row.setting}, {speed}")
    bound = measured(chart.tolerance, chart.unit)
    if not said:
        left = f"; settings not run for want of time: {chart.not_run}" if chart.not_run else ""
        return f"Nothing that was measured is shown to keep {bound}{left}."
    return f"The fastest within {bound} of physics. {'; '.join(s[0].upper() + s[1:] for s in said)}."


def beside(chart: Chart) -> str:
    """How many times as long each other program takes, at least and at most, and where least; beside each of 1,024
    motions at once too.
    """
    told = []
    for name in dict.fromkeys(peer.peer for peer in chart.peers):
        found = _ahead(chart, name, 1)
        if not found:
            continue
        (least, at), (most, _) = min(found), max(found)
        far = f"{least:.3g} to {most:.3g} times, least" if len(found) > 1 else f"{least:.3g} times,"
        text = f"{name}: {far} where it errs by {measured(at, chart.unit)}"
        many = [times for times, _ in _ahead(chart, name, 1024)]
        told.append(f"{text}; {min(many):.3g} times or more beside each of 1,024 at once." if many else f"{text}.")
    return " ".join(told)


def _ahead(chart: Chart, name: str, lanes: int) -> list[tuple[float, float]]:
    """(times, error) of a program's rows that the chart has one as good of."""
    own = [(chart.ahead(peer, lanes), peer.error or 0.0) for peer in chart.peers if peer.peer == name]
    return [(times, error) for times, error in own if times is not None]


def tables(chart: Chart) -> str:
    """The front, all rows, other programs, what has no result."""

    def line(row: Row) -> tuple[Any, ...]:
        return row.variant, row.setting, (row.seconds or 0) * 1e3, at_least(row.error), row.step_error

    def at_least(error: float | None) -> float | str | None:
        return f"< {number(chart.told_from)}" if error is not None and error < chart.told_from else error

    head = (
        "variant",
        "method",
        "ms per simulated second and lane",
        f"error [{chart.unit}]",
        f"of it by the step [{chart.unit}]",
    )
    text = paragraph("The Pareto front:") + table(head, [line(r) for r in chart.front])
    if chart.peers:
        other = ("program", "setting", "ms per simulated second", f"error [{chart.unit}]", "times", "why not")
        rows = [
            (
                p.peer,
                p.setting,
                None if p.seconds is None else p.seconds * 1e3,
                at_least(p.error),
                chart.ahead(p),
                p.failure or "",
            )
            for p in chart.peers
        ]
        words = "Other programs on the same motion, and how many times as long they take as the fastest row as good."
        text += paragraph(f"{words} {beside(chart)}") + table(other, rows)
    marked = [i for i, r in enumerate(chart.measured) if r.pareto]
    everything = table(head, [line(r) for r in chart.measured], marked=marked)
    text += details(f"All {len(chart.measured)} measured rows", everything)
    if chart.failed:
        reasons = table(("variant", "method", "reason"), [(r.variant, r.setting, r.failure) for r in chart.failed])
        text += details(f"{len(chart.failed)} settings without a result, and why", reasons)
    return text


def build(chart: Chart, svg: str, about: str = "") -> str:
    """The page's text; `svg` is the picture."""
    ref = chart.reference
    known = measured(ref.uncertainty, chart.unit)
    main = section("Speed against accuracy", paragraph(sentence(chart)) + interactive(chart, svg) + tables(chart))
    main += section(
        "What was measured",
        paragraph(
            f"Error: largest difference of {', '.join(chart.compare)} over the {chart.duration:g} s open-loop motion, "
            f"inputs held over each control period, from physics: {ref.how}, known to {known}; errors "
            f"below ten times that are not told apart from it. Time: wall time per "
            "simulated second and lane, median of several runs after a warm-up. The stepper is called once a "
            "control period, in one thread, and gives states; linear models are at hand, and what making them took is "
            "told beside."
        )
        + "".join(paragraph(f"{v} leaves the range of its kinematics: {w}.", "warning") for v, w in chart.outside)
        + table(("what", "value"), list(chart.machine.items())),
    )
    head = f"<h1>{escape(chart.scene)}</h1><p>{escape(about)}</p>"
    return document(chart.scene, head, main, f"Made by Pliant {escape(chart.machine['pliant'])}.", (script(),))


def save_all(chart: Chart, folder: Path, *, mark: Row | None = None, about: str = "") -> list[Path]:
    """Page, picture and table in the folder, named after the scene, which take their places together. OSError."""
    page, picture, data = (folder / f"{chart.scene}{ending}" for ending in ENDINGS)
    figure = speed_accuracy(chart, mark)
    with Together() as files:
        style.save(figure, picture, files)
        files.text(page, build(chart, style.inline(figure), about))
        chart.save(data, files)
    return [page, picture, data]

"""A scoreboard as json, as markdown and as a folder with both, every run, and one picture a scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.files.atomic_files import write_text
from pliant.plants.files.whole_folders import renewed
from pliant.studies.closed_loop.scores import Row
from pliant.studies.common import machine
from pliant.studies.common.atomic_files import write_json
from pliant.studies.common.formatting import measured
from pliant.studies.figures.scoreboard import profile_figure, scene_figure
from pliant.studies.figures.style import save

from .intervals import overall, profiles
from .kept_tasks import SUITE
from .lasting import what_lasts
from .results import Entry, Results
from .tasks import MANY

RUNS, PROFILES = "runs.npz", "profiles.png"
LEVELS = np.linspace(0.0, 1.0, 201)  # of bound / cost
WORDS = {
    "exact": "on the design model itself: no model error",
    "finer": "on the plant one fidelity higher",
    "varied": "finer plant; payload, stiffness, damping +-30 %, other starts, noise on every reading",
    "delayed": "finer plant, other starts, every input one control period late; its own parameters, no noise",
    "all at once": "the runs of `varied`, every input one control period late",
}
HEAD = (
    "controller",
    "cost",
    "/ bound",
    "middle",
    "median",
    "10 - 90 %",
    "failed",
    "settled [s]",
    "peak [mm]",
    "residual [mm]",
    "at limit",
    "effort",
    "act [us]",
    "99 % [us]",
)
NOTES = """\
Cost is the scene's, mean over the runs, with the charge for an early end. / bound: mean cost over the mean of the
least that a full-information optimal control problem reaches in the same runs; middle, median and 10 - 90 %: of the
single runs' ratios, the middle being the mean without the lowest and the highest quarter. In square brackets 95 %
intervals by the bootstrap of the runs; of failures, Clopper and Pearson's. Failed: runs that diverged, left a bound or
whose controller gave up. Settled: median time from which on
all that the goal names stays within 5 % of its way. Peak: largest deflection; residual: half of what it still swings
in the last tenth (where no body bends: of the lengths that the scene compares). At limit: share of the control periods
with an input at its limit. Effort: root mean square of the inputs, of their limits. Act: median and 99th percentile of
the time of one call. Controllers are designed on the design plant, for bounds 10 % inside those that end a run.
"""


def table(board: Results, command: str = "") -> dict[str, Any]:
    """For json: everything but the motions."""
    return {
        "suite": SUITE,
        "command": command,
        "seeds": board.seeds,
        "seed": board.seed,
        "cases": WORDS,
        "machine": machine.describe(),
        "scenes": [vars(entry) for entry in board.entries],
        "bounds": [
            {"scene": scene, "case": case, "costs": costs, "reason": board.remarks[scene, case]}
            for (scene, case), costs in board.bounds.items()
        ],
        "rows": [row.to_json() for row in board.rows],
        "overall": [] if board.raw is None else overall(board.raw),
    }


def write(board: Results, folder: Path, command: str = "") -> list[Path]:
    """scoreboard.json, scoreboard.md and SCENE.png in `folder`, which may hold a former board.

    All take their places at once when all are finished. OSError, which names the file.
    """
    names = ["scoreboard.json", "scoreboard.md", *(f"{entry.scene}.png" for entry in board.entries)]
    with renewed(folder) as made:
        write_json(made / names[0], table(board, command))
        write_text(made / names[1], markdown(board, command))
        for entry, name in zip(board.entries, names[2:]):
            save(scene_figure(board, entry.scene), made / name)
        if board.raw is not None:
            names += [RUNS, PROFILES]
            board.raw.save(made / RUNS)
            save(profile_figure({case: profiles(board.raw, case, LEVELS) for case in MANY}, LEVELS), made / PROFILES)
    return [folder / name for name in names]


def markdown(board: Results, command: str = "") -> str:
    """The tables, one a scene and case."""
    text = [f"# Scoreboard\n\nSuite `{SUITE}`.\n", NOTES]
    if command:
        text.append(f"Made by `{command}`: {board.seeds} runs of each of the last three cases, seed {board.seed}.\n")
    if board.raw is not None:
        text += over_scenes(overall(board.raw))
    text += what_lasts(board.rows)
    for entry in board.entries:
        text.append(f"## {entry.scene}\n\n{entry.about}. Designed on {entry.design} ({entry.design_states} states), ")
        text[-1] += f"played on {entry.plant} ({entry.plant_states} states), {entry.substeps} RK4 steps a period.\n"
        text[-1] += _from_physics(entry, board)
        if entry.remark:
            text.append(f"{entry.remark}: the cases after the first are played on it.\n")
        text.append(f"![{entry.scene}]({entry.scene}.png)\n")
        for case, words in WORDS.items():
            rows = [row for row in board.rows if (row.scene, row.case) == (entry.scene, case)]
            text += [f"**{case}**: {words}. {_bound(board, entry.scene, case)}\n", _rows(rows)]
            text += _reasons(rows)
    return "\n".join(text)


def _from_physics(entry: Entry, board: Results) -> str:
    """How far that plant is from physics, in words."""
    if entry.model_error is None or entry.model_known is None:
        return f"How far that is from physics is not known: {entry.model_remark}.\n"
    unit = board.scenes[entry.scene].unit
    apart, known = measured(entry.model_error, unit), measured(entry.model_known, unit)
    return f"That is {apart} from physics {entry.model_remark}, to {known}.\n"


def _bound(board: Results, scene: str, case: str) -> str:
    costs = board.bounds[scene, case]
    known = [c for c in costs if c is not None]
    if not known:
        return f"No bound: {board.remarks[scene, case] or 'none was asked for'}."
    part = f" of {len(known)} runs" if len(costs) > 1 else ""
    lost = f" ({len(costs) - len(known)} more were not found: {board.remarks[scene, case]})"
    return f"Bound {number(sum(known) / len(known))}{part}{lost if len(known) < len(costs) else ''}."


def _rows(rows: Sequence[Row]) -> str:
    lines = ["| " + " | ".join(HEAD) + " |", "|---|" + "---:|" * (len(HEAD) - 1)]
    lines += ["| " + " | ".join(cells(row)) + " |" for row in rows if row.runs]
    return "\n".join(lines) + "\n" if len(lines) > 2 else ""


def _reasons(rows: Sequence[Row]) -> list[str]:
    """Why rows are missing, and the first failure of each controller that failed."""
    lines = [f"- {row.controller}: none. {row.reason}" for row in rows if not row.runs]
    lines += [f"- {row.controller}: first failure: {row.reason}" for row in rows if row.runs and row.reason]
    return ["\n".join(lines) + "\n"] if lines else []


def cells(row: Row, *, intervals: bool = True) -> list[str]:
    """The cells of a row with runs: a number, and its interval where there is one."""
    many = row.runs > 1 and row.ratio_low is not None
    spread = f"{number(row.ratio_low)} - {number(row.ratio_high)}" if many else "-"
    settled = number(row.settling) if row.settling is not None else ("not" if row.unsettled else "-")
    failed = f"{row.failures}/{row.runs}" if row.failures else "0"

    def told(text: str, name: str, factor: float = 1.0) -> str:
        low, high = row.intervals.get(name, (math.nan, math.nan))
        return (
            text
            if math.isnan(low) or text == "-" or not intervals
            else f"{text} [{number(factor * low)}, {number(factor * high)}]"
        )

    return [
        row.controller,
        told(number(row.cost), "cost"),
        told(number(row.ratio), "ratio"),
        told(number(row.ratio_iqm) if many else "-", "ratio_iqm"),
        told(number(row.ratio_median) if many else "-", "ratio_median"),
        spread,
        told(failed, "failures"),
        told(settled, "settling") if settled != "not" else settled,
        told(number(None if row.peak is None else 1e3 * row.peak), "peak", 1e3),
        told(number(None if row.residual is None else 1e3 * row.residual), "residual", 1e3),
        told("-" if row.at_limit is None else f"{100 * row.at_limit:.0f} %", "at_limit", 100.0),
        told(number(row.effort), "effort"),
        told(number(row.act_median), "act_median"),
        told(number(row.act_p99), "act_p99"),
    ]


def over_scenes(lines: Sequence[Mapping[str, Any]]) -> list[str]:
    """The table over scenes, a line a controller and two columns a case."""
    cases = [case for case in WORDS if case in MANY]
    found = {(line["controller"], line["case"]): line for line in lines}
    head = ["controller", *(f"{case}: {what}" for case in cases for what in ("bound / cost", "better than LQR"))]
    text = [f"| {' | '.join(head)} |", "|---|" + "---:|" * (len(head) - 1)]
    for name in dict.fromkeys(line["controller"] for line in lines):
        row = [name]
        for case in cases:
            line = found.get((name, case), {})
            row += [_with(line, "iqm"), _with(line, "better")]
        text.append(f"| {' | '.join(row)} |")
    about = (
        "Over scenes: the mean of the middle half of bound / cost over all runs of the scenes that a controller\n"
        "plays, 1 being the best that can be done, and the probability that it does better than LQR on a run of a\n"
        "scene that both play. Controllers that play other scenes are not to be compared by the first.\n\n"
        "![Share of runs above each level of bound / cost](profiles.png)\n"
    )
    return [about, "\n".join(text) + "\n"]


def _with(line: Mapping[str, Any], name: str) -> str:
    if name not in line:
        return "-"
    low, high = line[f"{name}_interval"]
    scenes = f", {line['scenes']} scene{'s' * (line['scenes'] > 1)}" if name == "iqm" else ""
    return f"{line[name]:.3f} [{low:.3f}, {high:.3f}]{scenes}"


SHORT = ("single-link-slew", "single-link-slew-gentle", "two-link-reach", "two-link-reach-weak", "spacecraft-slew")


def short(found: Mapping[str, Any], scenes: Sequence[str] = SHORT) -> str:
    """One number a cell of a board's json: the median ratio with all at once, or how many runs failed; then the time of
    an act on two-link-reach."""
    rows = {(r["scene"], r["case"], r["controller"]): r for r in found["rows"]}
    names = [n for n in dict.fromkeys(r["controller"] for r in found["rows"]) if ", seed " not in n]
    lines = ["| cost / bound | " + " | ".join(scenes) + " | act [us] |", "|---|" + "---:|" * (len(scenes) + 1)]
    for name in names:
        act = rows.get(("two-link-reach", "varied", name), {}).get("act_median")
        cells = [_brief(rows.get((scene, "all at once", name), {})) for scene in scenes]
        lines.append(f"| {name} | " + " | ".join(cells) + f" | {'-' if act is None else f'{act:.3g}'} |")
    return "\n".join(lines) + "\n"


def _brief(row: Mapping[str, Any]) -> str:
    """The median ratio, or how many runs failed where any did."""
    if not row.get("runs"):
        return "-"
    if row["failures"]:
        return f"{row['failures']} fail"
    return "-" if row["ratio_median"] is None else f"{row['ratio_median']:.3g}"


def number(value: float | None) -> str:
    """Three digits, four near one, or a dash."""
    if value is None or not math.isfinite(value):
        return "-"
    if 0.8 <= abs(value) < 10:
        return f"{value:.3f}"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"

"""The pictures of the speed-accuracy chart and of the ladder of variants."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.files.atomic_files import Together
from pliant.studies.fidelity.choice import Choice
from pliant.studies.fidelity.speed_accuracy import RUNS_AWAY, Chart, Row

from . import style
from .style import COLOURS, INK, MARKERS, QUIET, panels, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

GOOD, FAIR, POOR = COLOURS[2], COLOURS[5], COLOURS[7]


@styled
def speed_accuracy(chart: Chart) -> Figure:
    """Time a simulated second against error, colour the variant, marker the method, with the Pareto front."""
    from matplotlib.lines import Line2D

    figure, (ax,) = panels(1, height=4.6)
    variants = list(dict.fromkeys(row.variant for row in chart.rows))
    methods = list(dict.fromkeys(row.method for row in chart.rows))
    colours = _colours(len(variants))
    lowest = 1e-7 * chart.tolerance
    highest = RUNS_AWAY * chart.tolerance
    rows = [(min(max(r.error or 0.0, lowest), highest), (r.seconds or 0.0) * 1e3, r) for r in chart.measured]
    for error, ms, row in rows:
        colour = colours[variants.index(row.variant)]
        marker = MARKERS[methods.index(row.method) % len(MARKERS)]
        ax.plot(error, ms, marker, color=colour, mfc=colour if row.pareto else "none", ms=6, mew=1.1, ls="none")
    front = sorted((error, ms) for error, ms, row in rows if row.pareto)
    if front:
        ax.step(*zip(*front), where="post", color=INK, lw=1.2, zorder=1)
    ax.axvline(chart.tolerance, color=COLOURS[7], lw=1.2, ls="--")
    if lowest < chart.reference.uncertainty < highest:
        ax.axvspan(lowest, chart.reference.uncertainty, color=QUIET, alpha=0.15, lw=0, zorder=0)
    aside: Any = {"ha": "right", "va": "top", "rotation": 90, "transform": ax.get_xaxis_transform()}
    ax.text(chart.tolerance, 0.99, "tolerance ", color=COLOURS[7], **aside)
    ax.set_xscale("log")
    ax.set_yscale("log")
    beyond = f", from {highest:g} {chart.unit} at the edge" if any(error == highest for error, _, _ in rows) else ""
    against = f"from physics, {chart.reference.variant}"
    ax.set_xlabel(f"largest error of {', '.join(chart.compare)} [{chart.unit}]{beyond}\n{against}")
    ax.set_ylabel("wall time per simulated second [ms]")
    ax.set_title(f"Speed against accuracy: {chart.scene}")
    drawn = {row.variant for row in chart.measured} | {row.method for row in chart.measured}
    by_variant = [
        Line2D([], [], color=colours[i], marker="o", ls="none", label=v) for i, v in enumerate(variants) if v in drawn
    ]
    by_method = [
        Line2D([], [], color=QUIET, mfc="none", marker=MARKERS[i % len(MARKERS)], ls="none", label=m)
        for i, m in enumerate(methods)
        if m in drawn
    ]
    by_method.append(Line2D([], [], color=INK, lw=1.2, label="Pareto front (filled)"))
    if lowest < chart.reference.uncertainty < highest:
        by_method.append(Line2D([], [], color=QUIET, alpha=0.3, lw=8, label="physics is not known better"))
    figure.legend(handles=[*by_variant, *by_method], loc="outside right upper")
    return figure


def _colours(n: int) -> list[Any]:
    """One for each variant: those of all pictures, or, of more variants, from dark to light as they grow dearer."""
    if n <= len(COLOURS):
        return list(COLOURS[:n])
    from matplotlib import colormaps

    return [colormaps["viridis"](0.95 * i / (n - 1)) for i in range(n)]


def save(chart: Chart, path: str | Path, together: Together | None = None) -> None:
    """Draw a chart into a file, as its ending says. Errors and `together` as `style.save`."""
    style.save(speed_accuracy(chart), path, together)


@styled
def ladder(choice: Choice) -> Figure:
    """Each rung's difference from physics, with the tolerance and how well physics is known."""
    figure, (ax,) = panels(1, height=0.32 * len(choice.rungs) + 1.0)
    rungs = choice.rungs
    lowest, highest = 1e-4 * choice.tolerance, RUNS_AWAY * choice.tolerance
    at = np.arange(len(rungs))
    for i, rung in enumerate(rungs):
        if rung.error is None:
            ax.text(lowest, i, " not tried", color=QUIET, va="center")
            continue
        colour = COLOURS[2] if rung.chosen else COLOURS[0]
        ax.barh(i, min(max(rung.error, lowest), highest), color=colour, height=0.55, alpha=0.85)
    ax.plot([], [], "s", color=COLOURS[0], label="from physics")
    ax.plot([], [], "s", color=COLOURS[2], label="the chosen one")
    if lowest < choice.convergence < highest:
        ax.axvspan(lowest, choice.convergence, color=QUIET, alpha=0.2, lw=0, label="physics is known to")
    ax.axvline(choice.tolerance, color=COLOURS[7], ls="--", lw=1.2, label="tolerance")
    ax.set_xscale("log")
    ax.set_xlim(left=lowest)
    ax.set_yticks(at, [r.variant for r in rungs])
    ax.set_ylim(len(rungs) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)
    beyond = f", from {highest:g} {choice.unit} at the edge" if any((r.error or 0.0) > highest for r in rungs) else ""
    ax.set_xlabel(f"largest difference of {', '.join(choice.compare)} [{choice.unit}]{beyond}")
    ax.set_title("The ladder, cheapest first")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def _letter(row: Row) -> str:
    """Why a setting has no result, in one letter."""
    known = {
        "Stability": "S",
        "MassMatrix": "M",
        "Integration": "D",
        "too slow": "T",
        "not run: dom": "-",
        "not run: runs": "R",
    }
    return next((v for k, v in known.items() if (row.failure or "").startswith(k)), "B")


@styled
def settings(chart: Chart) -> Figure:
    """Every variant by every setting: within the tolerance, past it, or without a result and why."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    variants = list(dict.fromkeys(row.variant for row in chart.rows))
    methods = list(dict.fromkeys(row.method for row in chart.rows))
    columns = sorted(
        {(methods.index(r.method), -(r.step or r.rtol or 0.0), r.setting) for r in chart.rows},
        key=lambda c: c[:2],
    )
    place = {label: i for i, (_, _, label) in enumerate(columns)}
    figure, (ax,) = panels(1, height=0.3 * len(variants) + 1.7)
    seen = set()
    for row in chart.rows:
        x, y = place[row.setting], variants.index(row.variant)
        if row.failure is None:
            colour = GOOD if (row.error or 0.0) <= chart.tolerance else FAIR
            ax.plot(x, y, "s", color=colour, ms=10, alpha=0.85)
            continue
        letter = _letter(row)
        seen.add(letter)
        ax.text(x, y, letter, ha="center", va="center", color=POOR if letter in "SMD" else QUIET, fontsize=8)
    for i in range(1, len(columns)):
        if columns[i][0] != columns[i - 1][0]:
            ax.axvline(i - 0.5, color=QUIET, lw=0.8)
    ax.set_xticks(range(len(columns)), [label for _, _, label in columns], rotation=90, fontsize=7)
    ax.set_yticks(range(len(variants)), variants)
    ax.set_xlim(-0.7, len(columns) - 0.3)
    ax.set_ylim(len(variants) - 0.4, -0.6)
    ax.grid(visible=False)
    ax.tick_params(length=0)
    ax.set_title("Every setting")
    meaning = {
        "S": "S: past the stability limit",
        "M": "M: mass matrix not definite",
        "D": "D: diverged",
        "R": "R: the model runs away",
        "T": "T: too slow",
        "-": "-: dominated, not run",
        "B": "B: time budget spent",
    }
    handles: list[Artist] = [
        Patch(color=GOOD, label="within the tolerance"),
        Patch(color=FAIR, label="past the tolerance"),
    ]
    handles += [Line2D([], [], ls="none", label=text) for key, text in meaning.items() if key in seen]
    handles.append(Line2D([], [], ls="none", label="blank: a coarser one is exact enough"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, handlelength=1.2)
    return figure

"""The pictures of the ladder of variants: how far each is from physics, which effects that is, and every setting of
`simulate`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.studies.fidelity.choice import Choice
from pliant.studies.fidelity.speed_accuracy import RUNS_AWAY, Chart, Row

from .style import COLOURS, QUIET, panels, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

GOOD, FAIR, POOR = COLOURS[2], COLOURS[5], COLOURS[7]


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
        if not np.isfinite(rung.error):
            ax.text(lowest, i, " no result", color=POOR, va="center")
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
    cut = any(highest < (r.error or 0.0) < np.inf for r in rungs)
    beyond = f", from {highest:g} {choice.unit} at the edge" if cut else ""
    ax.set_xlabel(f"largest difference of {', '.join(choice.compare)} [{choice.unit}]{beyond}")
    ax.set_title("The ladder, cheapest first")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


@styled
def effects(choice: Choice, times: np.ndarray) -> Figure | None:
    """What each effect moves the compared outputs by over the motion, times (nt,) [s]: the error's parts as lines, what
    the chosen model keeps dashed. None where no effect moves them by enough to be seen beside the tolerance.
    """
    lowest = 1e-4 * choice.tolerance
    drawn = [e for e in choice.effects if e.over_time is not None and lowest < e.change < RUNS_AWAY * choice.tolerance]
    if not drawn:
        return None
    figure, (ax,) = panels(1, height=3.0)
    for i, effect in enumerate(drawn):
        largest = np.abs(effect.over_time).max(axis=1)  # type: ignore[arg-type]
        label, line = (f"{effect.name}, kept", "--") if effect.kept else (effect.name, "-")
        ax.plot(times, np.maximum(largest, lowest), line, color=COLOURS[i], label=label)
    ax.axhline(choice.tolerance, color=QUIET, ls=":", lw=1.2, label="tolerance")
    ax.set_yscale("log")
    ax.set_ylim(bottom=lowest)
    ax.set_xlabel("time [s]")
    ax.set_ylabel(f"{', '.join(choice.compare)} [{choice.unit}]")
    ax.set_title(f"What {choice.plant.label} leaves out, and what it keeps")
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
    """Every variant by every setting of `simulate`: within the tolerance, past it, or without a result and why."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    rows = [row for row in chart.rows if row.path == "simulate"]
    variants = list(dict.fromkeys(row.variant for row in rows))
    methods = list(dict.fromkeys(row.method for row in rows))
    columns = sorted(
        {(methods.index(r.method), -(r.step or r.rtol or 0.0), r.setting) for r in rows},
        key=lambda c: c[:2],
    )
    place = {label: i for i, (_, _, label) in enumerate(columns)}
    figure, (ax,) = panels(1, height=0.3 * len(variants) + 1.7)
    seen = set()
    for row in rows:
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
    ax.set_title("Every setting of simulate")
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

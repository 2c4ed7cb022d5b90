"""The picture of predicted over true errors on random scenes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.studies.effectivity.effectivity import Effectivity
from pliant.studies.effectivity.tally import NARROW, WIDE

from .style import COLOURS, INK, MARKERS, QUIET, panels, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EDGES = np.geomspace(1 / 4, 4.0, 40)  # 1 is in the middle of a bin
LOW, HIGH = 1e-4, 10.0  # of the tolerance


@styled
def effectivity(found: Effectivity) -> Figure:
    """Predicted over true error of every rung tried, by kind of scene; and of the chosen ones, bound against truth."""
    kinds = list(dict.fromkeys(row["kind"] for row in found.rows if "kind" in row))
    figure, (ratios, chosen) = panels(1, 2, height=3.6, width=9.6)
    _histogram(ratios, found, kinds)
    _bounds(chosen, found, kinds)
    if kinds:
        figure.legend(*ratios.get_legend_handles_labels(), loc="outside lower center", ncols=len(kinds))
    return figure


def _histogram(ax: Axes, found: Effectivity, kinds: list[str]) -> None:
    """Ratios beyond the edges stand in the outermost bins."""
    tally = found.tally
    inside = np.sqrt(EDGES[:2].prod()), np.sqrt(EDGES[-2:].prod())
    values = [np.clip([one for kind, one in tally.ratios if kind == own], *inside) for own in kinds]
    if kinds:
        ax.hist(values, bins=EDGES.tolist(), stacked=True, color=[_colour(k) for k in range(len(kinds))], label=kinds)
    ax.set_xscale("log")
    ticks = (0.25, 0.5, 0.8, 1.0, 1.25, 2.0, 4.0)
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
    ax.set_xticks([], minor=True)
    for bounds, shade in ((WIDE, 0.10), (NARROW, 0.16)):
        ax.axvspan(*bounds, color=QUIET, alpha=shade, lw=0, zorder=0)
    ax.set_xlabel("predicted over true error (beyond 1/4 and 4: at the edge)")
    ax.set_ylabel("variants tried")
    ax.set_title(f"{len(tally.ratios)} predictions on {len(tally.known)} scenes")
    if not tally.ratios:
        return
    told = "\n".join(f"{100 * tally.share(b):.1f} % within {b[0]:g} to {b[1]:g}" for b in (WIDE, NARROW))
    ax.text(0.98, 0.97, told, transform=ax.transAxes, ha="right", va="top", color=INK)


def _bounds(ax: Axes, found: Effectivity, kinds: list[str]) -> None:
    """Of the chosen models: filled where "met"."""
    for row in found.tally.known:
        if row["true"] is None or row["bound"] is None:
            continue
        k, style = kinds.index(row["kind"]), {} if row["met"] else {"mfc": "none"}
        at = np.clip([row["true"] / row["tolerance"], row["bound"] / row["tolerance"]], LOW, HIGH)
        own: Any = {"color": _colour(k), "ls": "none", "ms": 5, **style}
        ax.plot(*at, MARKERS[k % len(MARKERS)], **own)
    ax.plot([], [], "o", color=INK, ls="none", ms=5, label="met")
    ax.plot([], [], "o", color=INK, mfc="none", ls="none", ms=5, label="refused")
    ax.axline((1.0, 1.0), slope=1.0, color=QUIET, lw=1.0, ls="--", zorder=1)
    ax.axvline(1.0, color=COLOURS[7], lw=1.2, ls="--", zorder=1)
    ax.axhline(1.0, color=COLOURS[7], lw=1.2, ls="--", zorder=1)
    ax.set(xscale="log", yscale="log", xlim=(LOW / 1.5, HIGH * 1.5), ylim=(LOW / 1.5, HIGH * 1.5))
    ax.set_xlabel("true error of the chosen over the tolerance")
    ax.set_ylabel("its bound over the tolerance")
    ax.legend(loc="upper left")
    wrong = len(found.tally.wrong)
    ax.set_title(f'The chosen: {sum(r["met"] for r in found.tally.known)} "met", {wrong} of them wrong')


def _colour(k: int) -> str:
    return COLOURS[k % len(COLOURS)]

"""The picture of a Campbell diagram: frequencies over the speed, the multiples of the speed, and where they meet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.argument_gates import require_instance
from pliant.plants.periodic import Campbell
from pliant.studies.figures.style import COLOURS, INK, QUIET, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@styled
def campbell_diagram(found: Campbell, title: str = "") -> Figure:
    """In Hz over revolutions per minute."""
    require_instance("campbell_diagram.found", found, Campbell)
    figure, (ax,) = panels(1, height=4.4)
    turns, hertz = found.speeds * 30 / np.pi, found.frequencies / (2 * np.pi)
    top = 1.08 * float(np.nanmax(hertz, initial=1e-12))
    for order in sorted({c.order for c in found.crossings}):
        ax.plot(turns, order * turns / 60, color=QUIET, lw=0.8, ls="--")
        end = 0.9 * min(turns[-1], 60 * top / order)
        ax.annotate(f"{order}x", (end, order * end / 60), color=QUIET, ha="right", va="bottom")
    for j in range(hertz.shape[1]):
        ax.plot(turns, hertz[:, j], color=COLOURS[j % len(COLOURS)], lw=1.6)
    for c in found.crossings:
        ax.plot(c.speed * 30 / np.pi, c.frequency / (2 * np.pi), "o", ms=5, mfc="none", color=INK)
    ax.set(xlabel="speed [rpm]", ylabel="frequency [Hz]", xlim=(turns[0], turns[-1]), ylim=(0, top), title=title)
    return figure

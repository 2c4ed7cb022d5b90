"""The picture of an identification: residuals of every sensor, and how neighbours in them are correlated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.argument_gates import require_instance
from pliant.plants.identification.identification import Identification
from pliant.plants.identification.residual_tests import autocorrelation
from pliant.studies.figures.style import COLOURS, INK, QUIET, panels, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 4000  # samples that are drawn of one motion
BAND = 1.96  # standard deviations within which 95 % of white noise stay


@styled
def residual_plot(found: Identification) -> Figure:
    """A row a sensor: residuals in standard deviations of its noise against time, motion by motion, and the
    autocorrelation of each, with the bands that hold 95 % of white noise. Every so many samples of long motions.

    >>> from pliant.studies.figures import save
    >>> save(residual_plot(identify(plant, motions)), "residuals.png")
    """
    found = require_instance("residual_plot.found", found, Identification)
    signals = list(found.noise)
    shape = {"width_ratios": (2.4, 1.0)}
    figure, axes = panels(len(signals), 2, height=1.9, gridspec_kw=shape)
    for row, name in enumerate(signals):
        draw(axes[2 * row], axes[2 * row + 1], found, name)
    if len(found.residuals) > 1:
        axes[0].legend(loc="upper right", markerscale=5)
    axes[-2].set_xlabel("time [s]")
    axes[-1].set_xlabel("lag [samples]")
    return figure


def draw(left: Axes, right: Axes, found: Identification, name: str) -> None:
    """The row of the sensor `name`."""
    fewest = np.inf
    for k, one in enumerate(found.residuals):
        if name not in one.signals:
            continue
        r = one.values[:, one.signals.index(name)] / found.noise[name]
        every, colour = max(1, len(r) // MOST), COLOURS[k % len(COLOURS)]
        left.plot(one.t[::every], r[::every], ".", ms=1.5, color=colour, label=one.name, rasterized=True)
        rho, pairs = autocorrelation(r)
        right.plot(np.arange(1, len(rho) + 1), rho, "o-", ms=2.5, lw=0.8, color=colour)
        fewest = min(fewest, max(1, pairs[0]))
    for end in (-BAND, BAND):
        left.axhline(end, color=INK, lw=0.7, ls="--")
        right.axhline(end / np.sqrt(fewest), color=INK, lw=0.7, ls="--")
    right.axhline(0.0, color=QUIET, lw=0.7)
    left.set_title(f"{name}: residuals over {found.noise[name]:.3g}")
    right.set_title("autocorrelation")

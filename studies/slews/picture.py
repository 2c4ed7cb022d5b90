"""Slews side by side: the inputs, the way, and the energy of the vibration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.argument_gates import require_all
from pliant.studies.figures.style import COLOURS, QUIET, panels, styled

from .comparison import Slew

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FLOOR = 1e-6  # of the largest energy, below which the picture does not go


@styled
def slews_picture(slews: Sequence[Slew], way: str) -> Figure:
    """way: the state or output that the turn brings to its goal. Time [s] along x; a colour a slew, in turn."""
    found = require_all("slews_picture.slews", slews, Slew)
    if not found:
        raise ValueError("slews_picture.slews = () must hold at least one Slew")
    figure, (above, middle, below) = panels(3, sharex=True)
    first = found[0].motion
    main = int(np.argmax(np.abs(found[0].motion.u).max(axis=0)))
    most = max(float(slew.energy.max()) for slew in found)
    for k, slew in enumerate(found):
        motion, colour = slew.motion, COLOURS[k % len(COLOURS)]
        above.plot(motion.t, motion.u[:, main], color=colour, label=f"{slew.profile}, largest {slew.largest:.3g}")
        middle.plot(motion.t, motion[way], color=colour)
        shown = np.maximum(slew.energy, FLOOR * most)
        below.plot(motion.t, shown, color=colour, label=f"{slew.profile}, {slew.left:.2g} J left")
    above.set_title(f"{first.inputs[main].name} [{first.inputs[main].unit}]")
    unit = {s.name: s.unit for s in first.states + first.outputs}[way]
    middle.set_title(f"{way} [{unit}]")
    below.set_title("energy above that of the goal [J]")
    below.set_yscale("log")
    below.set_xlabel("time [s]")
    for axes in (above, middle, below):
        axes.axvline(found[0].ends, color=QUIET, linewidth=0.8)
    above.legend(loc="upper right")
    below.legend(loc="lower right")
    return figure

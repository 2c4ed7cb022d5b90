"""Pictures of a spacecraft in space at several times of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from pliant.envs.rendering.spacecraft_geometry import exaggeration, reach_of, scenery
from pliant.envs.rendering.spatial import SUN, axis_words, draw_craft, set_up, sun_direction
from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleSpacecraft, Trajectory

from .style import QUIET, WIDTH, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COUNT = 6  # pictures of a motion


@styled
def snapshots(scene: Scene, motions: Sequence[tuple[str, Trajectory]], *, count: int = COUNT) -> Figure:
    """A row for each motion: hub and panels at `count` times from start to end, deflections enlarged as it says."""
    from matplotlib.figure import Figure

    craft = cast(FlexibleSpacecraft, scene.plant)  # as it is drawn as one
    factor, reach, words = exaggeration(scene), reach_of(craft), axis_words(craft)
    figure = Figure(figsize=(WIDTH * 1.25, 1.7 * len(motions) + 0.3))
    often = f", deflections drawn {factor} times" if factor > 1 else ""
    figure.suptitle(f"The spacecraft in reference axes{often}", x=0.01, ha="left", fontsize=10, fontweight="bold")
    top = 1.0 - 0.3 / figure.get_figheight()
    for row, (name, motion) in enumerate(motions):
        picks = np.unique(np.linspace(0, len(motion.t) - 1, count).round().astype(int))
        for column, k in enumerate(picks):
            high = top / len(motions)
            place = (column / count, top - (row + 1) * high, 1.0 / count, 0.9 * high)
            axes = figure.add_axes(place, projection="3d")
            axes.patch.set_alpha(0.0)
            shown = words if column == 0 else ("", "", words[2] if "Earth" in words[2] else "")
            set_up(axes, reach, shown, zoom=1.9)
            draw_craft(axes, scenery(craft, motion.x[k], factor))
            sun = sun_direction(craft, float(motion.t[k]))
            if sun is not None:
                axes.plot(*(0.7 * reach * sun[:, None]), "o", color=SUN, ms=7)
            label = f"{name}, {motion.t[k]:g} s" if column == 0 else f"{motion.t[k]:g} s"
            figure.text(place[0] + 0.01, place[1] + 0.93 * place[3], label, fontsize=8.5, color=QUIET)
    return figure

"""Pictures of a scene with a spacecraft: hub and bent panels in three dimensions, its goal, the sun, the inputs."""

from __future__ import annotations

from typing import Any, cast

import casadi as ca
import numpy as np

from pliant.plants import FlexibleSpacecraft

from .captions import caption
from .planar import GOAL, INK, RENDERERS
from .space_picture import SpacePicture
from .spacecraft_geometry import Scenery, exaggeration, reach_of, scenery

SUN, HUB, PANEL = "#e0a100", "#b9c2cc", "#3b6fb6"
VIEW = {"elev": 24.0, "azim": -120.0}
EARTH_DOWN = {"elev": -24.0, "azim": 58.0, "roll": 180.0}


def draw_craft(axes: Any, drawn: Scenery, *, alpha: float = 1.0) -> list[Any]:
    """Hub and panels on 3-D axes; returns what was added."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    made: list[Any] = []
    box = Poly3DCollection(drawn.box, facecolor=HUB, edgecolor=INK, linewidths=0.6, alpha=alpha)
    made.append(axes.add_collection3d(box))
    for pair in drawn.roots.reshape(-1, 2, 3):
        made += axes.plot(*pair.T, color=INK, lw=1.6, alpha=alpha)
    for sheet in drawn.sheets:
        if sheet.shape[1] == 1:
            made += axes.plot(*sheet[:, 0].T, color=PANEL, lw=2.5, alpha=alpha)
            continue
        faces = np.stack([sheet[:-1, 0], sheet[1:, 0], sheet[1:, 1], sheet[:-1, 1]], axis=1)
        panel = Poly3DCollection(faces, facecolor=PANEL, edgecolor="none", alpha=0.8 * alpha)
        made.append(axes.add_collection3d(panel))
        made += axes.plot(*around(sheet).T, color=INK, lw=0.6, alpha=alpha)
    return made


def around(sheet: np.ndarray) -> np.ndarray:
    """The closed edge (k, 3) of a sheet (m, 2, 3)."""
    return np.concatenate([sheet[:, 0], sheet[::-1, -1], sheet[:1, 0]])


def set_up(axes: Any, reach: float, words: tuple[str, str, str], triad: float = 0.62, zoom: float = 1.45) -> None:
    """Equal scales without a frame, and the reference axes from the origin."""
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach, reach))
    axes.set_box_aspect((1, 1, 1), zoom=zoom)
    axes.view_init(**(EARTH_DOWN if "Earth" in words[2] else VIEW))
    axes.set_axis_off()
    for direction, word in zip(np.eye(3), words):
        end = triad * reach * direction
        axes.plot(*np.stack([np.zeros(3), end]).T, color="#8a9099", lw=0.9)
        axes.text(*(1.08 * end), word, color="#5b616b", fontsize=9, ha="center", va="center")


def axis_words(craft: FlexibleSpacecraft) -> tuple[str, str, str]:
    """What the reference axes are."""
    return ("x, velocity", "y", "z, Earth") if craft.environment.orbit is not None else ("x", "y", "z")


def sun_direction(craft: FlexibleSpacecraft, t: float) -> np.ndarray | None:
    """Unit vector (3,) to the sun in reference axes, None without one."""
    outside = craft.environment
    if outside.sun is None:
        return None
    return np.array(ca.DM(ca.densify(ca.evalf(outside.sun.at(ca.SX(t), outside.orbit))))).ravel()


class SpaceRenderer(SpacePicture):
    """Draws one scene of a spacecraft again and again; keeps the first tip's path since the last `clear`."""

    def _set_up(self) -> None:
        scene, craft = self.scene, cast(FlexibleSpacecraft, self.scene.plant)  # as it is drawn as one
        self._craft, self._factor = craft, exaggeration(scene)
        self._reach = reach_of(craft)
        set_up(self._space, self._reach, axis_words(craft))
        if scene.goal_at_rest:
            goal = scenery(craft, scene.target[0])
            for sheet in goal.sheets:
                self._space.plot(*around(sheet).T, color=GOAL, lw=1.4, ls=(0, (3, 2)), alpha=0.8)
        self._moving: list[Any] = []

    def _about(self) -> str:
        return caption(self.scene, self._factor)

    def draw(self, x: np.ndarray, action: np.ndarray, time: float, cost: float) -> np.ndarray | None:
        for artist in self._moving:
            artist.remove()
        drawn = scenery(self._craft, x, self._factor)
        self._moving = draw_craft(self._space, drawn)
        sun = sun_direction(self._craft, time)
        if sun is not None:
            ray = self._reach * np.stack([1.02 * sun, 0.72 * sun])
            self._moving += self._space.plot(*ray.T, color=SUN, lw=2.0)
            self._moving += self._space.plot(*ray[:1].T, "o", color=SUN, ms=12)
        self._go_on(drawn.sheets[0][-1].mean(axis=0) if drawn.sheets else np.zeros(3))
        return self._show(action, time, cost)


RENDERERS["spacecraft"] = SpaceRenderer

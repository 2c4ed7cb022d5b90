"""Pictures of a scene with a tree of bodies that moves in space: its bodies as lines, its goal, the path of its tip."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from pliant.plants import FlexibleTree

from .planar import GOAL, INK, LINKS, PALE, RENDERERS, TIP
from .space_picture import SpacePicture

VIEW = {"elev": 20.0, "azim": -62.0}
BEND = "#3182bd"  # of a body that bends


class TreeRenderer(SpacePicture):
    """Draws one scene of a tree again and again; keeps the tip's path since the last `clear`."""

    _links: list[Any]
    _base: Any
    _joints: Any
    _payload: Any
    _drop: Any

    def _place(self) -> tuple[float, float, float, float]:
        low = 0.04 + 0.03 * len(self.scene.plant.inputs)
        return (0.0, low, 1.0, 0.98 - low)

    def _set_up(self) -> None:
        scene, tree = self.scene, cast(FlexibleTree, self.scene.plant)  # as it is drawn as one
        goal = tree.lines(scene.target[0])
        start = tree.lines(scene.initial[0])
        seen = np.concatenate([np.zeros((1, 3)), *goal, *start])
        middle, reach = (seen.max(axis=0) + seen.min(axis=0)) / 2, 0.62 * float(np.ptp(seen, axis=0).max())
        space = self._space
        limits = [(float(m - reach), float(m + reach)) for m in middle]
        space.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
        space.set_box_aspect((1, 1, 1), zoom=1.35)
        space.view_init(**VIEW)
        space.set_axis_off()
        self._low = limits[2][0]
        if any(tree.nominal.gravity):
            self._floor(limits)
        if scene.goal_at_rest:
            for line in goal:
                space.plot(*line.T, color=GOAL, lw=1.8, ls=(0, (3, 2)), alpha=0.8)
            space.plot(*goal[-1][-1:].T, "o", ms=14, mfc="none", mec=GOAL, mew=2, alpha=0.8)
        self._moves = tree.base == "free"  # its first states are then where it is
        (self._base,) = space.plot([0], [0], [0], "s", ms=26 if self._moves else 12, color=INK)
        self._links = [space.plot([], [], [], lw=5.0, solid_capstyle="round", color=LINKS[0])[0] for _ in goal]
        (self._joints,) = space.plot([], [], [], "o", ms=7, mfc="white", mec=INK, mew=1.6)
        (self._payload,) = space.plot([], [], [], "o", ms=11, mfc=TIP, mec="white", mew=1.2)
        (self._drop,) = space.plot([], [], [], color=PALE, lw=1.2)

    def _floor(self, limits: list[tuple[float, float]]) -> None:
        """A grid below everything, which shows where up is."""
        (left, right), (near, far), (low, _) = limits
        for at in np.linspace(0.0, 1.0, 7):
            x, y = left + at * (right - left), near + at * (far - near)
            self._space.plot([x, x], [near, far], [low, low], color=PALE, lw=0.8, zorder=0)
            self._space.plot([left, right], [y, y], [low, low], color=PALE, lw=0.8, zorder=0)

    def draw(self, x: np.ndarray, action: np.ndarray, time: float, cost: float) -> np.ndarray | None:
        tree = cast(FlexibleTree, self.scene.plant)
        lines = tree.lines(x)
        for artist, line in zip(self._links, lines, strict=True):
            artist.set_data_3d(*line.T)
            artist.set_color(BEND if bent(line) else LINKS[0])
        self._joints.set_data_3d(*np.array([line[0] for line in lines]).T)
        if self._moves:
            self._base.set_data_3d(*x[:3, None])
        tip = lines[-1][-1]
        self._payload.set_data_3d(*tip[:, None])
        if any(tree.nominal.gravity):
            self._drop.set_data_3d([tip[0]] * 2, [tip[1]] * 2, [tip[2], self._low])
        self._go_on(tip)
        return self._show(action, time, cost)


def bent(line: np.ndarray) -> bool:
    """Whether a line (k, 3) is not straight."""
    along = line[-1] - line[0]
    away = np.cross(line - line[0], along)
    return bool(np.abs(away).max() > 1e-9 * max(float(along @ along), 1e-30))


RENDERERS["tree"] = TreeRenderer

"""What pictures of machines in space share: axes in three dimensions, the path of a point, words and bars over them."""

from __future__ import annotations

from typing import Any

import numpy as np

from .captions import caption
from .planar import INK, TIP, Renderer

TRAIL = 400  # points of the path that are kept


class SpacePicture(Renderer):
    """Draws one scene again and again in 3-D axes whose frame is set once; keeps a path since the last `clear`."""

    def _prepare(self) -> None:
        self._space: Any = self.figure.add_axes(self._place(), projection="3d")
        self._space.patch.set_alpha(0.0)
        self._behind: Any
        self._set_up()
        (self._behind,) = self._space.plot([], [], [], color=TIP, lw=1.3, alpha=0.7)
        axes = self.axes = self.figure.add_axes((0, 0, 1, 1))
        axes.patch.set_alpha(0.0)
        axes.axis("off")
        text: dict[str, Any] = {"transform": axes.transAxes, "va": "top", "color": INK, "fontsize": 10}
        axes.text(0.03, 0.975, self._about(), linespacing=1.4, **text)
        self._status = axes.text(0.97, 0.975, "", ha="right", linespacing=1.4, **text)
        self._bars = [self._bar(0.03 + 0.034 * i, s.name) for i, s in enumerate(reversed(self.scene.plant.inputs))]

    def _place(self) -> tuple[float, float, float, float]:
        """Left, bottom, width and height of the axes in space [of the figure]."""
        return (0.0, 0.04, 1.0, 0.92)

    def _set_up(self) -> None:
        """What stands still in space, and the artists of what moves."""
        raise NotImplementedError

    def _about(self) -> str:
        return caption(self.scene)

    def _look(self) -> None:
        """The frame of a machine in space is set once."""

    def _go_on(self, point: np.ndarray) -> None:
        """The path on to a point (3,)."""
        self._path.append(point)
        self._behind.set_data_3d(*np.array(self._path[-TRAIL:]).T)

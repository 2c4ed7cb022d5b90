"""Pictures of a scene: the bent arm, its goal where that is a place, the path of its tip, the inputs.

Any plant with `outline(x, points) -> (links, points, 2)` [m] can be drawn; a spacecraft is in `spatial`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant
from pliant.plants.core.parameters import require_choice
from pliant.plants.core.signals import OwnsArrays, names

from .captions import caption

PIXELS = 600
LINKS = ("#1f4e79", "#3182bd", "#6baed6", "#9ecae1")
GOAL, TIP, INK, PALE = "#2e9e5b", "#d9622b", "#303030", "#e4e7ea"


def renderer(scene: Scene, *, window: bool = False) -> Renderer:
    """What draws the scene, as its plant's `drawn_as` says: an arm in its plane, a spacecraft in space."""
    require_choice(type(scene.plant).__name__, "drawn_as", scene.plant.drawn_as, tuple(RENDERERS))
    return RENDERERS[scene.plant.drawn_as](scene, window=window)


class Renderer(OwnsArrays):
    """Draws one scene again and again; keeps the tip's path since the last `clear`."""

    def __init__(self, scene: Scene, *, window: bool = False) -> None:
        self.scene, self.window = scene, window
        if window:
            import matplotlib.pyplot as plt

            self.figure = plt.figure(figsize=(6, 6))  # its own: a figure of a name is the same one for all who ask
            if self.figure.canvas.manager is not None:
                self.figure.canvas.manager.set_window_title(scene.name)
            plt.show(block=False)
        else:
            from matplotlib.backends.backend_agg import FigureCanvasAgg
            from matplotlib.figure import Figure

            self.figure = Figure(figsize=(6, 6), dpi=PIXELS / 6)
            FigureCanvasAgg(self.figure)
        self._path: list[np.ndarray] = []
        self._frame = np.zeros((2, 2))
        self._prepare()

    def _prepare(self) -> None:
        from matplotlib.collections import LineCollection

        scene = self.scene
        goal = scene.plant.outline(scene.target[0])
        if not len(goal):
            raise ValueError(f"scene {scene.name!r}: its plant {type(scene.plant).__name__} has no outline to draw")
        reach = _length(goal)
        axes = self.axes = self.figure.add_axes((0, 0, 1, 1))
        start = np.concatenate([*scene.plant.outline(scene.initial[0]), *goal])
        self._stands = _root_stands(scene.plant, goal[0][0], reach) and not _slides(scene.plant)
        self._frame = np.array([goal[0][0] - reach, goal[0][0] + reach])  # (2, 2): least and most
        if not self._stands:
            self._frame = np.array([start.min(axis=0), start.max(axis=0)])
        self._least = reach
        self._look()
        axes.set(aspect="equal")
        axes.axis("off")
        if self._stands:
            self._draw_reach(goal[0][0], reach)
        if scene.goal_at_rest:  # a goal that moves has no shape of its own
            for link in goal:
                axes.plot(*link.T, color=GOAL, lw=2, ls=(0, (3, 2)), alpha=0.7, zorder=1)
            axes.plot(*goal[-1][-1], "o", ms=17, mfc="none", mec=GOAL, mew=2, alpha=0.7, zorder=1)
        self._trail = LineCollection([], linewidths=2.2, zorder=2, capstyle="butt")
        axes.add_collection(self._trail)
        style: dict[str, Any] = {"solid_capstyle": "round", "zorder": 4}
        self._links = [
            axes.plot([], [], color=LINKS[i % len(LINKS)], lw=max(9 - 2 * i, 4), **style)[0] for i in range(len(goal))
        ]
        size = 24 if self._stands else 15
        (self._root,) = axes.plot(*goal[0][0], "s", ms=size, color=INK, zorder=3)
        thin: dict[str, Any] = {"color": INK, "lw": 0.8, "ls": (0, (4, 3)), "zorder": 3}
        self._tangents = [axes.plot([], [], **thin)[0] for _ in goal]  # where an unbent link would lie
        (self._joints,) = axes.plot([], [], "o", ms=11, mfc="white", mec=INK, mew=2.2, zorder=5)
        (self._payload,) = axes.plot([], [], "o", ms=13, mfc=TIP, mec="white", mew=1.5, zorder=6)
        text: dict[str, Any] = {"transform": axes.transAxes, "va": "top", "color": INK, "fontsize": 11}
        axes.text(0.03, 0.975, caption(scene), linespacing=1.4, **text)
        self._status = axes.text(0.97, 0.975, "", ha="right", linespacing=1.4, **text)
        self._bars = [self._bar(0.035 + 0.04 * i, s.name) for i, s in enumerate(reversed(scene.plant.inputs))]

    def _draw_reach(self, root: np.ndarray, reach: float) -> None:
        """How far an arm on a base can reach."""
        angle = np.linspace(0, 2 * np.pi, 181)
        self.axes.plot(*(root + reach * np.column_stack([np.cos(angle), np.sin(angle)])).T, color=PALE, lw=1, zorder=0)
        for direction in np.eye(2):
            self.axes.plot(*(root[:, None] + np.outer(direction, (-reach, reach))), color=PALE, lw=1, zorder=0)

    def _look(self) -> None:
        """Show the frame, with room around it for the words."""
        half = max(float(np.ptp(self._frame, axis=0).max()) / 2, 0.5 * self._least)
        x, y = self._frame.mean(axis=0)
        self.axes.set(xlim=(x - 1.25 * half, x + 1.25 * half), ylim=(y - 1.33 * half, y + 1.17 * half))

    def _follow(self, links: np.ndarray) -> None:
        """Widen the frame where a machine that moves about has left it."""
        ends = np.concatenate(list(links))
        wide = np.array([np.minimum(self._frame[0], ends.min(axis=0)), np.maximum(self._frame[1], ends.max(axis=0))])
        if np.abs(wide - self._frame).max() > 0:
            self._frame = wide
            self._look()

    def _bar(self, height: float, name: str) -> Any:
        """A horizontal bar from the middle: one input over its limit."""
        from matplotlib.patches import Rectangle

        axes = self.axes
        options: dict[str, Any] = {"transform": axes.transAxes, "zorder": 3}
        axes.add_patch(Rectangle((0.3, height), 0.4, 0.018, color=PALE, lw=0, **options))
        axes.text(
            0.285,
            height + 0.009,
            name,
            ha="right",
            va="center",
            color=INK,
            fontsize=10,
            transform=axes.transAxes,
        )
        bar = axes.add_patch(Rectangle((0.5, height), 0.0, 0.018, color=LINKS[1], lw=0, **options))
        axes.plot([0.5, 0.5], [height - 0.004, height + 0.022], color=INK, lw=1, transform=axes.transAxes)
        return bar

    def __getstate__(self) -> dict[str, Any]:
        """A figure does not travel: what it shows is drawn anew."""
        path = [np.array(point) for point in self._path]
        return {"scene": self.scene, "window": self.window, "path": path, "frame": np.array(self._frame)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        Renderer.__init__(self, state["scene"], window=state["window"])
        self._path += [np.array(point) for point in state["path"]]
        self._frame = np.array(state["frame"])
        self._look()

    def clear(self) -> None:
        """Forget the tip's path."""
        self._path.clear()

    def draw(self, x: np.ndarray, action: np.ndarray, time: float, cost: float) -> np.ndarray | None:
        """The state x (nx,) under an action (nu,) in [-1, 1]: (height, width, 3) uint8, None in a window."""
        from matplotlib.colors import to_rgb

        links = np.asarray(self.scene.plant.outline(x))
        self._root.set_data(*links[0][:1].T)
        if not self._stands:
            self._follow(links)
        for artist, tangent, link in zip(self._links, self._tangents, links):
            artist.set_data(*link.T)
            length = np.linalg.norm(np.diff(link, axis=0), axis=1)
            straight = link[0] + (link[1] - link[0]) * 1.06 * length.sum() / (length[0] or 1.0)
            tangent.set_data(*np.transpose([link[0], straight]))
        self._joints.set_data(*links[:, 0].T)
        tip = links[-1][-1]
        self._payload.set_data([tip[0]], [tip[1]])
        self._path.append(tip)
        path = np.array(self._path)
        segments = np.stack([path[:-1], path[1:]], axis=1)
        fade = np.linspace(0.08, 0.85, len(segments))
        self._trail.set_segments(list(segments))
        self._trail.set_color([(*to_rgb(TIP), alpha) for alpha in fade])
        return self._show(action, time, cost)

    def _show(self, action: np.ndarray, time: float, cost: float) -> np.ndarray | None:
        """The picture with the inputs, the time and the cost written into it."""
        for bar, value in zip(self._bars, np.clip(action, -1.0, 1.0)[::-1]):
            bar.set_width(0.2 * value)
        self._status.set_text(f"{time:.2f} s\ncost {cost:.2f}")
        self.figure.canvas.draw()
        if self.window:
            self.figure.canvas.flush_events()
            return None
        return np.asarray(self.figure.canvas.buffer_rgba())[..., :3].copy()  # type: ignore[attr-defined]

    def close(self) -> None:
        """Close the window, if there is one."""
        if self.window:
            import matplotlib.pyplot as plt

            plt.close(self.figure)


def _root_stands(plant: Plant, root: np.ndarray, reach: float) -> bool:
    """Whether the first link begins at one place whatever the state: an arm on a base, not a trolley."""
    x = plant.rest_state
    for k in range(plant.nx):
        moved = plant.consistent(x + 0.1 * (np.arange(plant.nx) == k))
        if np.abs(plant.outline(moved, 2)[0][0] - root).max() > 1e-9 * reach:
            return False
    return True


def _slides(plant: Plant) -> bool:
    """Whether a driven joint makes the lines longer, as a trolley's rail: no circle is then what it can reach."""
    x, known = plant.rest_state, names(plant.states)
    rest = _length(plant.outline(x, 2))
    moved = (plant.consistent(x + 0.1 * (np.arange(plant.nx) == known.index(joint.position))) for joint in plant.joints)
    return any(abs(_length(plant.outline(state, 2)) - rest) > 1e-9 * (rest + 0.1) for state in moved)


def _length(lines: Any) -> float:
    """Of all lines together [m]."""
    return float(sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines))


RENDERERS: dict[str, Callable[..., Renderer]] = {"links": Renderer}  # by `Plant.drawn_as`; other modules add theirs

"""The pictures of a motion, of an arm's shape and of a spacecraft in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from pliant.envs.rendering.spacecraft_geometry import exaggeration, reach_of, scenery
from pliant.envs.rendering.spatial import SUN, VIEW, axis_words, draw_craft, set_up, sun_direction
from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleSpacecraft, FlexibleTree, Plant, Trajectory
from pliant.plants.core.signals import Signal, names

from . import arm_outline
from .style import COLOURS, INK, QUIET, WIDTH, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNITS = {  # in the order of the panels
    "1": "attitude",
    "rad": "angles",
    "rad/s": "turning rates",
    "m": "lengths",
    "m/s": "speeds",
    "m/s^2": "accelerations",
    "N": "forces",
    "N m": "torques",
    "N m s": "momenta",
}
DEFLECTED = {"m": "deflections", "m/s": "rates of deflection"}
APART = 30.0  # ratio of the peaks of signals that are not drawn in one panel
ROUNDING = 1e-9  # of the largest peak, below which a signal is no more than that
LONG_LABEL = 18  # characters of a label above which it has two lines
COUNT = 6  # pictures of a motion in space
NARROW = 5.0  # ratio of the sides of a path above which it would be a strip
MANY = 6  # panels above which there are two columns


def words(name: str) -> str:
    """A signal's name for a legend."""
    return name.replace("_", " ")


def _groups(scene: Scene, motions: Sequence[Trajectory]) -> list[tuple[str, list[str]]]:
    """Names of the goal's states and of the outputs by unit and size, without what the tip's path shows; the inputs."""
    outputs, signals = scene.plant.outputs, _told_states(scene)
    on_the_path = scene.compare if len(scene.compare) >= 2 else ()
    signals += [s for s in outputs if s.name not in on_the_path]
    zero, bending = still(scene, motions), _bending(scene.plant)
    signals = [s for s in signals if s.name not in zero]
    found = []
    for unit, label in UNITS.items():
        own = [[s.name] for s in signals if s.unit == unit and s.name in scene.compare]  # else it may hide
        rest = [s.name for s in signals if s.unit == unit and s.name not in scene.compare]
        for chosen in (*own, *_alike(rest, motions)):
            bent = all(name in bending for name in chosen) or (unit == "m" and arm_outline.in_space(scene.plant))
            found.append((f"{DEFLECTED.get(unit, label) if bent else label} [{unit}]", chosen))
    inputs = [s for s in scene.plant.inputs if s.name not in zero]
    for unit in dict.fromkeys(s.unit for s in inputs):
        found.append((f"inputs [{unit}]", [s.name for s in inputs if s.unit == unit]))
    return found


def _told_states(scene: Scene) -> list[Signal]:
    """The states that goal or cost name and that are no outputs already."""
    outputs, told = scene.plant.outputs, {*dict(scene.goal), *dict(scene.goal_rates), *scene.weighted}
    hidden = {*names(outputs), *scene.plant.repeated, *scene.plant.attitude_states}
    return [s for s in scene.plant.states if s.name in told and s.name not in hidden]


def _bending(plant: Plant) -> set[str]:
    """Outputs that are deflections or their rates."""
    return {*plant.deflections, *(plant.output_rates[n] for n in plant.deflections if n in plant.output_rates)}


def still(scene: Scene, motions: Sequence[Trajectory]) -> tuple[str, ...]:
    """What would be drawn but is zero throughout every motion."""
    signals = names((*_told_states(scene), *scene.plant.outputs, *scene.plant.inputs))
    return tuple(name for name in signals if not any(np.any(m[name]) for m in motions))


def _alike(chosen: list[str], motions: Sequence[Trajectory]) -> list[list[str]]:
    """The signals in groups whose peaks are of one size, largest first; what is only rounding is in the first.

    A signal that another one equals throughout is left out.
    """
    seen: dict[bytes, str] = {}
    for name in chosen:
        seen.setdefault(b"".join(m[name].tobytes() for m in motions), name)
    chosen = list(seen.values())
    peak = {name: max(float(np.abs(m[name]).max()) for m in motions) for name in chosen}
    least = ROUNDING * max(peak.values(), default=0.0)
    peak = {name: value if value > least else 0.0 for name, value in peak.items()}
    groups: list[list[str]] = []
    for name in sorted((n for n in chosen if peak[n] > 0), key=lambda n: -peak[n]):
        if not groups or APART * peak[name] < peak[groups[-1][0]]:
            groups.append([])
        groups[-1].append(name)
    still = [name for name in chosen if peak[name] == 0]
    if still:
        groups = [[*(groups[0] if groups else ()), *still], *groups[1:]]
    return [sorted(group, key=chosen.index) for group in groups]


@styled
def histories(scene: Scene, motions: Sequence[tuple[str, Trajectory]], *, title: str = "") -> Figure:
    """Angles, deflections, their rates and inputs against time; several motions differ by line style."""
    from matplotlib.lines import Line2D

    groups = _groups(scene, [motion for _, motion in motions])
    columns = 1 if len(groups) <= MANY else 2
    rows = -(-len(groups) // columns)
    figure, axes = panels(rows, columns, height=1.45, width=WIDTH * (1.0 if columns == 1 else 1.4), sharex=True)
    if len(axes) > len(groups):  # the last panel is as wide as two
        wide = axes[-2].get_subplotspec().get_gridspec()[-1, :]  # type: ignore[union-attr]
        axes.pop().remove()
        axes[-1].set_subplotspec(wide)
    goal, limits = dict(scene.goal), dict(zip(names(scene.plant.inputs), scene.limits))
    styles = ("-", "--", ":", "-.")
    for ax, (label, chosen) in zip(axes, groups):
        for i, name in enumerate(chosen):
            for k, (_, motion) in enumerate(motions):
                held = "steps-post" if name in limits and motion.hold == "zero-order" else "default"
                style = styles[k % len(styles)]
                ax.plot(motion.t, motion[name], style, color=COLOURS[i], drawstyle=held, lw=1.4 - 0.2 * (k > 0))
            ax.plot([], [], color=COLOURS[i], label=words(name))
            if name in goal:
                ax.axhline(goal[name], color=COLOURS[i], lw=0.8, ls=(0, (1, 3)))
        shown = max(np.abs(m[n]).max() for _, m in motions for n in chosen)
        for i, name in enumerate(chosen):
            if name in limits and limits[name] < 1.3 * shown:
                for sign in (-1, 1):
                    ax.axhline(sign * limits[name], color=COLOURS[i], lw=0.8, ls=(0, (5, 2)), alpha=0.7)
        ax.set_ylabel(label if len(label) <= LONG_LABEL else label.replace(" [", "\n["))
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    for ax in axes[-columns:]:
        ax.set_xlabel("time [s]")
    axes[0].set_title(title)
    if len(motions) > 1:
        lines = [Line2D([], [], color=INK, ls=styles[k % len(styles)], label=n) for k, (n, _) in enumerate(motions)]
        figure.legend(handles=lines, loc="outside lower center", ncols=min(len(lines), 4))
    return figure


@styled
def tip_path(scene: Scene, motions: Sequence[tuple[str, Trajectory]]) -> Figure:
    """The path of the tip for each motion: in its plane, or in space from above and from the side."""
    first, *others = scene.compare
    views = [(first, other) for other in others[:2]]
    figure, axes = panels(1, len(views), height=3.2, width=6.4 if len(views) == 1 else 1.2 * WIDTH)
    figure.set_layout_engine("compressed")  # else the legend beside equal axes is cut off
    known = names(scene.plant.outputs)
    ends = [(scene.plant.measure(*scene.initial), "o", "start"), (scene.plant.measure(*scene.target), "*", "goal")]
    for ax, (x, y) in zip(axes, views):
        for i, (name, motion) in enumerate(motions):
            ax.plot(motion[x], motion[y], color=COLOURS[i], label=name, lw=1.6 - 0.2 * i)
            every = max(1, round(0.25 / (motion.t[1] - motion.t[0])))
            ax.plot(motion[x][::every], motion[y][::every], ".", color=COLOURS[i], ms=4)
        for point, marker, label in ends:
            at = [point[known.index(n)] for n in (x, y)]
            ax.plot(*at, marker, color=INK, ms=9 if marker == "*" else 6, mfc="none", label=label, zorder=4)
        wide, high = (np.ptp(limits) for limits in (ax.get_xlim(), ax.get_ylim()))
        flat = max(wide, high) > NARROW * min(wide, high)
        ax.set_aspect("auto" if flat else "equal", adjustable="box")
        ax.set_box_aspect(0.6 if flat else None)
        if not flat and wide < high:
            ax.locator_params(axis="x", nbins=2 if 2 * wide > high else 1)
            if 2 * wide < high:  # three ticks would touch
                inside = [x for x in ax.get_xticks() if ax.get_xlim()[0] <= x <= ax.get_xlim()[1]]
                ax.set_xticks([inside[0], inside[-1]] if inside else [])
        ax.set_xlabel(f"{words(x)} [m]")
        ax.set_ylabel(f"{words(y)} [m]" + (", stretched" if flat and high < wide else ""))
    axes[0].set_title("Tip path, a dot every 0.25 s")
    axes[-1].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


@styled
def stroboscopic(
    cases: Sequence[tuple[str, Plant, Trajectory]], *, count: int = 16, until: float | None = None
) -> Figure:
    """The arm's shape at `count` times, early ones faint, side by side for each case; with the tip's path."""
    from matplotlib.collections import LineCollection

    ends = np.concatenate([arm_outline.lines(plant, motion.x[::10]).reshape(-1, 2) for _, plant, motion in cases])
    wide, high = np.ptp(ends, axis=0)
    flat = 1.2 + WIDTH / len(cases) * high / max(wide, 1e-9)
    height = 3.6 if arm_outline.whirls(cases[0][1], cases[0][2]) else min(3.6, flat)
    figure, axes = panels(1, len(cases), height=height, sharex=True, sharey=True)
    figure.set_layout_engine("compressed")
    for ax, (name, plant, motion) in zip(axes, cases):
        last = len(motion.t) if until is None else int(np.searchsorted(motion.t, until * (1 + 1e-9))) + 1
        picks = np.unique(np.linspace(0, min(last, len(motion.t)) - 1, count).round().astype(int))
        from_hub = arm_outline.whirls(plant, motion)
        curves = arm_outline.lines(plant, motion.x[picks], from_hub=from_hub)
        faint = LineCollection(list(curves), colors=COLOURS[0], linewidths=1.3)
        faint.set_alpha(list(np.linspace(0.2, 1.0, len(picks))))
        ax.add_collection(faint)
        everywhere = arm_outline.lines(plant, motion.x[:last], from_hub=from_hub)
        ax.plot(*everywhere[:, -1].T, color=COLOURS[1], lw=1.0, label="tip")
        roots = curves[:, 0]
        stands = bool(np.ptp(roots, axis=0).max() <= 1e-9 * max(wide, high))
        ax.plot(*(roots[:1] if stands else roots).T, "o", color=INK, ms=5 if stands else 2.5)
        ax.plot(*curves[:, -1].T, ".", color=COLOURS[1], ms=5)
        ax.set_aspect("auto" if from_hub else "equal", adjustable="box")
        ax.autoscale_view()
        ax.set_title(f"{name}, seen from the hub, {plant.outline_axes[1]} stretched" if from_hub else name)
        ax.set_xlabel(f"{plant.outline_axes[0]} [m]")
        ax.axhline(roots[0, 1], color=QUIET, lw=0.5, zorder=0)
    axes[0].set_ylabel(f"{cases[0][1].outline_axes[1]} [m]")
    return figure


@styled
def strobe_in_space(
    cases: Sequence[tuple[str, Plant, Trajectory]], *, count: int = 12, until: float | None = None
) -> Figure:
    """As `stroboscopic`, of trees in three dimensions, up as the base's z."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(1.15 * WIDTH, 0.56 * WIDTH))
    spans = []
    for column, (name, plant, motion) in enumerate(cases):
        axes: Any = figure.add_subplot(1, len(cases), column + 1, projection="3d")
        last = len(motion.t) if until is None else int(np.searchsorted(motion.t, until * (1 + 1e-9))) + 1
        picks = np.unique(np.linspace(0, min(last, len(motion.t)) - 1, count).round().astype(int))
        tree = cast(FlexibleTree, plant)  # as it is drawn as one
        shapes = [tree.lines(x, arm_outline.POINTS) for x in motion.x[picks]]
        for alpha, shape in zip(np.linspace(0.2, 1.0, len(picks)), shapes):
            for line in shape:
                axes.plot(*line.T, color=COLOURS[0], lw=1.3, alpha=alpha)
            axes.plot(*shape[-1][-1:].T, ".", color=COLOURS[1], ms=5)
        path = np.array([tree.lines(x, 2)[-1][-1] for x in motion.x[:last]])
        axes.plot(*path.T, color=COLOURS[1], lw=1.0)
        axes.plot(*shapes[0][0][:1].T, "o", color=INK, ms=5)
        axes.set_title(name)
        axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        drawn = np.concatenate([path, *(line for shape in shapes for line in shape)])
        spans.append((axes, drawn.min(axis=0), drawn.max(axis=0)))
    low, high = np.min([s[1] for s in spans], axis=0), np.max([s[2] for s in spans], axis=0)
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, 0.15 * float(np.max(high - low)))
    for axes, _, _ in spans:
        axes.set(**{f"{a}lim": (m - h, m + h) for a, m, h in zip("xyz", middle, half)})
        axes.set_box_aspect(tuple(half), zoom=0.88)
        axes.view_init(**VIEW)
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            axis.set_major_locator(MaxNLocator(3))
            axis.labelpad = 8
            axis.pane.set_alpha(0.0)
        axes.patch.set_alpha(0.0)
    figure.subplots_adjust(left=0.05, right=0.98, bottom=0.07, top=0.92, wspace=0.16)
    return figure


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

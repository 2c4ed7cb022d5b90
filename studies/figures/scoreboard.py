"""One picture a scene: the ratios of cost to bound, controller by controller, and the motions beside the best one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.studies.closed_loop.scores import Row, deflections

from .motion import words
from .style import COLOURS, INK, MARKERS, QUIET, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CEILING = 30.0  # ratios above are drawn at the edge, with their number
CASES = ("exact", "finer", "varied", "delayed", "all at once")
CLOSE = 3.0  # ratio above which a motion is not drawn: it would hide the others
SEED = ", seed "  # in the name of one of several policies: only the marks of each are drawn


class Line(Protocol):
    """A motion: t (n,) [s], goal signals and deflections by name (n,), inputs (n - 1, nu)."""

    @property
    def t(self) -> np.ndarray: ...
    @property
    def signals(self) -> Mapping[str, np.ndarray]: ...
    @property
    def u(self) -> np.ndarray: ...


class Board(Protocol):
    """What is drawn of a scoreboard: its rows, why bounds are missing by (scene, case), scenes as they were played,
    and motions by (scene, controller or "bound").
    """

    @property
    def rows(self) -> Sequence[Row]: ...
    @property
    def remarks(self) -> Mapping[tuple[str, str], str]: ...
    @property
    def scenes(self) -> Mapping[str, Scene]: ...
    @property
    def lines(self) -> Mapping[tuple[str, str], Line]: ...
    def row(self, scene: str, case: str, controller: str) -> Row: ...


@styled
def scene_figure(board: Board, scene: str) -> Figure:
    """Left: the ratios, log scale, the median with the 10 - 90 % range. Right: motions on the finer plant."""
    from matplotlib.figure import Figure

    rows = [row for row in board.rows if row.scene == scene]
    ranked = _ranked(board, scene)
    figure = Figure(figsize=(11.0, max(4.2, 1.2 + 0.42 * len(ranked))), layout="constrained")
    parts: Any = figure.subfigures(1, 2, width_ratios=(1.0, 1.15))
    left, right = parts
    ax = left.subplots()
    places = {name: i for i, name in enumerate(ranked)}
    for k, case in enumerate(CASES):
        for row in rows:
            if row.case != case or row.controller not in places:
                continue
            _mark(ax, places[row.controller] + 0.16 * (k - 2), row, COLOURS[k], MARKERS[k])
        ax.plot([], [], color=COLOURS[k], marker=MARKERS[k], linestyle="none", label=case)
    ax.axvline(1.0, color=INK, linewidth=1.0)
    ax.set_xscale("log")
    most = max((min(row.ratio_high, CEILING) for row in rows if row.ratio_high is not None), default=2.0)
    most = max(2.0, most)
    ax.set_xlim(most**-0.03, most**1.08)
    ticks = [t for t in (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0) if t <= most and (most < 5.0 or t != 1.2)]
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
    if board.remarks.get((scene, "finer")):
        text = "\n".join(wrap(f"no bound: {board.remarks[scene, 'finer']}", 40))
        ax.text(0.5, 0.5, text, transform=ax.transAxes, ha="center", va="center")
    ax.minorticks_off()
    ax.set_yticks(range(len(ranked)), ranked)
    ax.set_ylim(len(ranked) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)
    ax.set_xlabel("cost / bound")
    ax.set_title(f"{scene}: cost over the least possible")
    left.legend(loc="outside lower center", ncols=len(CASES))
    _motions(right, board, scene, ranked)
    return figure


@styled
def profile_figure(curves: Mapping[str, Mapping[str, np.ndarray]], at: np.ndarray) -> Figure:
    """The share of runs with bound / cost above a level, by case and controller; `at` (n,) are the levels."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    order = list(dict.fromkeys(name for of in curves.values() for name in of if SEED not in name))
    axes: Any = np.atleast_1d(figure.subplots(1, len(curves), sharey=True))
    for ax, (case, of) in zip(axes, curves.items()):
        for name in (name for name in of if name in order):
            ax.plot(at, of[name], label=name, alpha=0.9, **_line(order.index(name)))
        ax.set_title(case)
        ax.set_xlabel("bound / cost above")
        ax.set_xlim(0, 1)
    axes[0].set_ylabel("share of runs")
    handles = {label: h for ax in axes for h, label in zip(*ax.get_legend_handles_labels())}
    if handles:
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=6, fontsize=7.5)
    return figure


def _line(k: int) -> dict[str, Any]:
    """Colour and dash of the curve number k."""
    return {"color": COLOURS[k % len(COLOURS)], "linestyle": ("-", "--", ":", "-.")[k // len(COLOURS) % 4]}


def _mark(ax: Axes, y: float, row: Row, colour: str, marker: str) -> None:
    median, low, high, failures, runs = row.ratio_median, row.ratio_low, row.ratio_high, row.failures, row.runs
    if median is None or low is None or high is None:
        return
    shown = min(median, CEILING)
    ax.plot([min(low, CEILING), min(high, CEILING)], [y, y], color=colour, linewidth=2.0, alpha=0.5)
    ax.plot([shown], [y], color=colour, marker=">" if median > CEILING else marker, markersize=5)
    if failures:
        text = f"{failures}/{runs} failed" if runs > 1 else "failed"
        ax.annotate(text, (min(high, CEILING), y), (5, 0), textcoords="offset points", fontsize=5.5, va="center")


def _ranked(board: Board, scene: str) -> list[str]:
    """Controllers with a score, the least ratio on the finer plant first."""
    found = {row.controller: row for row in board.rows if row.scene == scene and row.case == "finer" and row.runs}
    return sorted(found, key=lambda name: found[name].ratio or found[name].cost or np.inf)


def _motions(figure: Any, board: Board, scene: str, ranked: list[str]) -> None:
    played = board.scenes[scene]
    near = [n for n in ranked if (board.row(scene, "finer", n).ratio or 1.0) <= CLOSE and SEED not in n]
    lines = [(name, board.lines[scene, name]) for name in ("bound", *near) if (scene, name) in board.lines]
    if not lines:
        return
    signals = _chosen(lines[0][1], deflections(played))
    drive = int(np.argmax(np.ptp(lines[0][1].u, axis=0) / np.array(played.limits)))
    axes = figure.subplots(len(signals) + 1, 1, sharex=True)
    units = {s.name: s.unit for s in played.signals}
    order = list(dict.fromkeys(row.controller for row in board.rows))
    for name, line in lines:
        style: dict[str, Any] = _line(order.index(name)) if name in order else {}
        style = style or {"color": INK, "linewidth": 2.4}
        for ax, signal in zip(axes, signals):
            ax.plot(line.t, line.signals[signal], label=name, alpha=0.9, **style)
        axes[-1].step(line.t[: len(line.u)], line.u[:, drive], where="post", alpha=0.9, **style)
    for ax, signal in zip(axes, signals):
        ax.set_ylabel(f"{words(signal)}\n[{units[signal]}]")
    shown = played.plant.inputs[drive]
    axes[-1].set_ylabel(f"{words(shown.name)}\n[{shown.unit}]")
    for limit in (played.limits[drive], -played.limits[drive]):
        axes[-1].axhline(limit, color=QUIET, linestyle=":", linewidth=1.0)
    axes[-1].set_xlabel("t [s]")
    left_out = f", ratio up to {CLOSE:g}" if len(near) < len([n for n in ranked if SEED not in n]) else ""
    axes[0].set_title(f"Motions on the finer plant{left_out}")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", fontsize=7.5)


def _chosen(line: Line, bent: Sequence[str]) -> list[str]:
    """Of the signals that the goal names, and of the deflections, the one that moves most."""
    span = {name: float(np.ptp(values)) for name, values in line.signals.items()}
    groups = [name for name in span if name not in bent], [name for name in span if name in bent]
    return [max(group, key=lambda name: span[name]) for group in groups if group]

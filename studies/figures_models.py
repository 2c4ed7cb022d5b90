"""The pictures of linear models, of the speed-accuracy chart and of the ladder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from pliant.plants import LTVModel

from .style import COLOURS, INK, MARKERS, QUIET, panels

if TYPE_CHECKING:
    from .chart import Chart
    from .fidelity import Choice


def eigenvalues(sets: Sequence[tuple[str, np.ndarray]]) -> Figure:
    """Eigenvalues [1/s] in the complex plane, upper half, both axes scaled by symmetric logarithms."""
    figure, (ax,) = panels(1, height=3.8, width=6.4)
    for i, (name, values) in enumerate(sets):
        values = np.asarray(values)
        upper = values[values.imag >= -1e-9]
        marker, filled = ("x", True) if i == 0 else (MARKERS[i % len(MARKERS)], False)
        ax.plot(
            upper.real,
            upper.imag,
            marker,
            color=COLOURS[i],
            mfc=COLOURS[i] if filled else "none",
            ms=7,
            mew=1.5,
            label=name,
        )
    ax.axvline(0, color=INK, lw=0.8)
    ax.set_xscale("symlog", linthresh=0.1)
    ax.set_yscale("symlog", linthresh=1.0)
    ax.set_ylim(bottom=-0.3)
    ax.set_xlabel("real part [1/s]")
    ax.set_ylabel("imaginary part [rad/s]")
    ax.set_title("Eigenvalues at the goal")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def frozen(model: LTVModel) -> Figure:
    """Frozen-time eigenvalues along a nominal motion: damped frequencies [Hz] and real parts [1/s] against time."""
    found = np.linalg.eigvals(model.A)
    figure, axes = panels(2, height=2.2, sharex=True)
    frequency = np.sort(np.where(found.imag > 1e-6, found.imag, np.nan) / (2 * np.pi), axis=1)
    for i in range(int(np.isfinite(frequency).sum(axis=1).max(initial=0))):
        axes[0].plot(model.t, frequency[:, i], ".", color=COLOURS[i % len(COLOURS)], ms=2.5)
    axes[0].set_yscale("log")
    axes[0].set_ylabel("damped frequency [Hz]")
    axes[0].set_title("Frozen eigenvalues along the nominal motion")
    slow = np.abs(found) < 200 * np.pi
    axes[1].plot(model.t, np.where(slow, found.real, np.nan), ".", color=COLOURS[0], ms=2.0)
    axes[1].plot(model.t, found.real.max(axis=1), color=COLOURS[1], lw=1.4, label="rightmost")
    axes[1].axhline(0, color=INK, lw=0.8)
    axes[1].set_yscale("symlog", linthresh=1.0)
    axes[1].set_ylabel("real part [1/s]")
    axes[1].set_xlabel("time [s]")
    axes[1].legend(loc="best")
    return figure


def speed_accuracy(chart: Chart) -> Figure:
    """Time a simulated second against error, colour the variant, marker the method, with the Pareto front."""
    figure, (ax,) = panels(1, height=4.6)
    variants = list(dict.fromkeys(row.variant for row in chart.rows))
    methods = list(dict.fromkeys(row.method for row in chart.rows))
    lowest = 1e-3 * chart.tolerance
    rows = [(max(r.error or 0.0, lowest / 3), (r.seconds or 0.0) * 1e3, r) for r in chart.measured]
    for error, ms, row in rows:
        colour = COLOURS[variants.index(row.variant) % len(COLOURS)]
        marker = MARKERS[methods.index(row.method) % len(MARKERS)]
        ax.plot(error, ms, marker, color=colour, mfc=colour if row.pareto else "none", ms=6, mew=1.1, ls="none")
    front = sorted((error, ms) for error, ms, row in rows if row.pareto)
    if front:
        ax.step(*zip(*front), where="post", color=INK, lw=1.2, zorder=1)
    ax.axvline(chart.tolerance, color=COLOURS[7], lw=1.2, ls="--")
    ax.text(
        chart.tolerance, 1.01, "tolerance", color=COLOURS[7], ha="center", transform=ax.get_xaxis_transform()
    )
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel(f"largest error of {', '.join(chart.compare)} [m]")
    ax.set_ylabel("wall time per simulated second [ms]")
    ax.set_title("Speed against accuracy")
    by_variant = [
        Line2D([], [], color=COLOURS[i % len(COLOURS)], marker="o", ls="none", label=v) for i, v in enumerate(variants)
    ]
    by_method = [
        Line2D([], [], color=QUIET, mfc="none", marker=MARKERS[i % len(MARKERS)], ls="none", label=m)
        for i, m in enumerate(methods)
    ]
    by_method.append(Line2D([], [], color=INK, lw=1.2, label="Pareto front (filled)"))
    figure.legend(handles=[*by_variant, *by_method], loc="outside right upper")
    return figure


def ladder(choice: Choice) -> Figure:
    """Each rung's difference from the finest and from its next finer neighbour, with the tolerance."""
    figure, (ax,) = panels(1, height=0.32 * len(choice.rungs) + 1.0)
    rungs = choice.rungs
    lowest = 1e-4 * choice.tolerance
    at = np.arange(len(rungs))
    for i, rung in enumerate(rungs):
        colour = COLOURS[2] if rung.chosen else COLOURS[0]
        ax.barh(i, max(rung.error, lowest), color=colour, height=0.55, alpha=0.85)
        if rung.change is not None:
            ax.plot(max(rung.change, lowest), i, "D", color=COLOURS[1], ms=5)
    ax.plot([], [], "s", color=COLOURS[0], label="from the finest")
    ax.plot([], [], "s", color=COLOURS[2], label="the chosen one")
    ax.plot([], [], "D", color=COLOURS[1], label="from the next rung")
    ax.axvline(choice.tolerance, color=COLOURS[7], ls="--", lw=1.2, label="tolerance")
    ax.set_xscale("log")
    ax.set_xlim(left=lowest)
    ax.set_yticks(at, [r.variant for r in rungs])
    ax.invert_yaxis()
    ax.grid(axis="y", visible=False)
    ax.set_xlabel(f"largest difference of {', '.join(choice.compare)} [m]")
    ax.set_title("The ladder, cheapest first")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure

"""The pictures of stability: evidence along a nominal, multipliers, and charts over two parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from pliant.plants.finite_horizon import FiniteHorizon
from pliant.plants.finite_horizon.asked import listed
from pliant.plants.stability import Floquet, FrozenTime, Growth, Verdict

from .linear_models import ROUNDED, plain_labels
from .style import COLOURS, INK, QUIET, panels, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FILL = {
    "stable": "#bfe3d0",
    "bounded": "#d5e6f5",
    "drift": "#e6d9f0",
    "marginal": "#f3e3a8",
    "undecided": "#dcdfe4",
    "unstable": "#f0b6b6",
    "failed": "#5b616b",
}


class VerdictMap(Protocol):
    """What `chart` draws: row i of the arrays belongs to values[0][i], column j to values[1][j]."""

    @property
    def names(self) -> tuple[str, str]: ...
    @property
    def values(self) -> tuple[np.ndarray, np.ndarray]: ...
    @property
    def verdicts(self) -> np.ndarray: ...  # (n0, n1) words of FILL
    @property
    def margins(self) -> np.ndarray: ...  # (n0, n1) [1/s]
    def share(self, verdict: str) -> float: ...


@styled
def evidence(verdict: Verdict, *, title: str = "Stability", height: float = 2.3) -> Figure:
    """How far an output is pushed, how much deviations grow, frozen roots, and multipliers of a periodic model.

    Each panel `height` [in] high.
    """
    frozen: FrozenTime | None = verdict.evidence.get("frozen_time")
    grown: Growth | None = verdict.evidence.get("growth")
    cycle: Floquet | None = verdict.evidence.get("floquet")
    roots = verdict.evidence.get("eigenvalues")
    drawers: list[tuple[Any, Any]] = []
    if verdict.horizon is not None:
        drawers.append((_tube, verdict.horizon))
    if grown is not None:
        drawers.append((_growth, grown))
    if frozen is not None and len(frozen.t) > 1:
        drawers += [(_real_parts, frozen), (_frequencies, frozen)]
    if cycle is not None:
        drawers.append((_multipliers, cycle))
    if not drawers:
        drawers.append((_roots, np.zeros(0) if roots is None else roots))
    figure, axes = panels(len(drawers), height=height)
    for ax, (draw, result) in zip(axes, drawers):
        draw(ax, result)
        if draw in (_frequencies, _real_parts, _growth):
            for time in verdict.critical_times:
                ax.axvline(time, color=COLOURS[1], ls=":", lw=1.0)
    timed = [draw in (_tube, _growth, _real_parts, _frequencies) for draw, _ in drawers]
    over_time = [ax for ax, here in zip(axes, timed) if here]
    for ax in over_time:
        ax.set_xlim(min(a.get_xlim()[0] for a in over_time), max(a.get_xlim()[1] for a in over_time))
    for ax, here, below in zip(axes, timed, [*timed[1:], False]):
        if here and below:
            ax.tick_params(labelbottom=False)
        elif here:  # the lowest of those over time
            ax.set_xlabel("time [s]")
    head = verdict.verdict + (f" of {listed(verdict.drifting[:3])}" if verdict.drifting else "")
    axes[0].set_title(f"{title}: {head}")
    return figure


def _tube(ax: Axes, horizon: FiniteHorizon) -> None:
    """How far the output that is pushed furthest can be off its nominal at each time."""
    worst = horizon.furthest
    low, high = horizon.tube[worst.name].T
    reach = (high - low) / 2
    times, unit = (
        (1e3, "mm") if worst.unit == "m" and reach.max() < 0.1 else (1.0, "" if worst.unit == "1" else worst.unit)
    )
    limits = horizon.limits_said
    ax.fill_between(horizon.t_tube, -times * reach, times * reach, color=COLOURS[0], alpha=0.25, lw=0, label=limits)
    for side in (-1, 1):
        label = "of unit energy" if side > 0 else None
        ax.plot(horizon.t, side * times * horizon.by_energy[worst.name], color=COLOURS[1], lw=1.2, label=label)
    ax.set_ylabel(f"{worst.name}\noff its nominal" + (f" [{unit}]" if unit else ""))
    by = ", ".join(s.name for s in horizon.disturbances)
    ax.legend(loc="upper left", ncols=2, title=by, title_fontsize=7, alignment="left")


def _frequencies(ax: Axes, frozen: FrozenTime) -> None:
    found = frozen.eigenvalues.imag
    found = np.sort(np.where(found > 1e-6, found, np.nan) / (2 * np.pi), axis=1)
    ax.plot(frozen.t, found, ".", color=COLOURS[0], ms=2.5)
    if np.isfinite(found).any():
        ax.set_yscale("log")
        ax.set_ylim(0.7 * np.nanmin(found), 1.4 * np.nanmax(found))
        _plain(ax)
    ax.set_ylabel("frozen frequency\n[Hz]")


def _plain(ax: Axes) -> None:
    """Numbers without powers of ten where the axis spans little."""
    low, high = ax.get_ylim()
    if high < 1e3 * low and low > 1e-3 and high < 1e5:
        ax.yaxis.set_major_formatter("{x:g}")
        ax.yaxis.set_minor_formatter(plain_labels() if high < 12 * low else "")


def _real_parts(ax: Axes, frozen: FrozenTime) -> None:
    ax.plot(frozen.t, frozen.eigenvalues.real, ".", color=COLOURS[0], ms=2.0)
    ax.plot(frozen.t, frozen.rightmost, color=COLOURS[1], lw=1.4, label="rightmost")
    ax.axhline(0, color=INK, lw=0.8)
    near = max(1e-2 * float(np.abs(frozen.eigenvalues).max()), 1e-9)
    size = float(np.abs(frozen.eigenvalues.real).max())
    if size > 3 * near:
        ax.set_yscale("symlog", linthresh=10 ** np.ceil(np.log10(near)))  # so that no power of ten stands beside 0
    elif size < ROUNDED * np.abs(frozen.eigenvalues).max():
        ax.set_ylim(-near, near)
    ax.set_ylabel("frozen real part\n[1/s]")
    ax.legend(loc="best")


def _growth(ax: Axes, grown: Growth) -> None:
    ax.plot(grown.t, grown.curve, color=COLOURS[0], label="since the start")
    ax.plot(grown.window_start, grown.windows, color=COLOURS[2], label=f"in the next {grown.window:.3g} s")
    ax.axhline(1, color=INK, lw=0.8)
    ax.set_yscale("log")
    _plain(ax)
    ax.set_ylabel("largest growth")
    ax.legend(loc="best")


def _multipliers(ax: Axes, cycle: Floquet) -> None:
    turn = np.linspace(0, 2 * np.pi, 200)
    ax.plot(np.cos(turn), np.sin(turn), color=QUIET, lw=1.0)
    for mask, colour, name in ((~cycle.outside, COLOURS[0], "inside or on"), (cycle.outside, COLOURS[7], "outside")):
        if mask.any():
            ax.plot(cycle.multipliers.real[mask], cycle.multipliers.imag[mask], "x", color=colour, ms=6, label=name)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_ylabel("Floquet\nmultipliers")
    ax.set_xlabel(f"period {cycle.period:.4g} s")
    ax.legend(loc="best")


def _roots(ax: Axes, roots: np.ndarray) -> None:
    ax.plot(roots.real, roots.imag, "x", color=COLOURS[0], ms=6)
    ax.axvline(0, color=INK, lw=0.8)
    ax.set_xlabel("real part [1/s]")
    ax.set_ylabel("imaginary part\n[rad/s]")


@styled
def chart(found: VerdictMap, *, title: str = "Stability chart", labels: tuple[str, str] | None = None) -> Figure:
    """Verdicts as colours over the two parameters, the first upwards; lines of equal growth where it is unstable."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    kinds = list(FILL)
    figure, (ax,) = panels(1, height=4.4, width=6.4)
    codes = np.vectorize(kinds.index)(found.verdicts)
    across, up = found.values[1], found.values[0]
    colours = ListedColormap([FILL[k] for k in kinds])
    ax.pcolormesh(across, up, codes, cmap=colours, vmin=-0.5, vmax=len(kinds) - 0.5, shading="nearest")
    growth = np.where(np.isfinite(found.margins), -found.margins, 0.0)
    if min(growth.shape) > 1 and growth.max() > 0:
        levels = np.linspace(0, growth.max(), 6)[1:-1]
        lines = ax.contour(across, up, growth, levels=levels, colors=INK, linewidths=0.6)
        ax.clabel(lines, fmt="%.2g", fontsize=7)
    first, second = labels or found.names
    ax.set_ylabel(first)
    ax.set_xlabel(second)
    ax.set_title(title)
    ax.grid(False)
    seen = [k for k in kinds if (found.verdicts == k).any()]
    handles = [Patch(color=FILL[k], label=f"{k} {100 * found.share(k):.0f} %") for k in seen]
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure

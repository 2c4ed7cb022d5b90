"""The pictures of linear models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import LTVModel

from .style import COLOURS, INK, MARKERS, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogFormatter

SMALL = 1e-2  # of the usual range, below which eigenvalues would all be drawn at zero
NOTHING = 1e-6  # real parts below this share of the largest eigenvalue are rounding
ROUNDED = 1e-12  # and these are rounding even where all that is told apart from zero is small


def plain_labels() -> LogFormatter:
    """Labels like 0.6 and 20 on a logarithmic axis, where matplotlib's own formatter sets one."""
    from matplotlib.ticker import LogFormatter

    class Plain(LogFormatter):
        def __call__(self, x: float, pos: int | None = None) -> str:
            return f"{x:g}" if super().__call__(x, pos) else ""

    return Plain(labelOnlyBase=False, minor_thresholds=(2, 0.4))


@styled
def eigenvalues(sets: Sequence[tuple[str, np.ndarray]], *, title: str = "Eigenvalues at the goal") -> Figure:
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
    every = np.concatenate([np.asarray(values) for _, values in sets])
    told = np.where(np.abs(every.real) > ROUNDED * np.abs(every).max(initial=0.0), every.real, 0.0)
    across, up = _linear_up_to(told, 0.1), _linear_up_to(every.imag, 1.0)
    ax.set_xscale("symlog", linthresh=across)
    ax.set_yscale("symlog", linthresh=up)
    ax.set_xlim(2 * min(told.min(), -0.5 * across), 3 * max(told.max(), across))
    ax.set_ylim(-0.4 * up, 2 * max(every.imag.max(), up))
    ax.set_xlabel("real part [1/s]")
    ax.set_ylabel("imaginary part [rad/s]")
    ax.set_title(title)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def _linear_up_to(values: np.ndarray, usual: float) -> float:
    """Where a symmetric logarithm begins: as usual, or at the decade of the least value where that is far below."""
    sizes = np.abs(values)
    sizes = sizes[sizes > NOTHING * sizes.max(initial=0.0)]
    least = float(sizes.min(initial=usual))
    return usual if least > SMALL * usual else 10.0 ** float(np.floor(np.log10(least)))


@styled
def frozen(model: LTVModel) -> Figure:
    """Frozen-time eigenvalues along a motion: damped frequencies [Hz] and real parts [1/s] against time."""
    every = max(1, len(model.t) // 160)
    t, found = model.t[::every], np.linalg.eigvals(model.A[::every])
    figure, axes = panels(2, height=2.2, sharex=True)
    frequency = np.sort(np.where(found.imag > 1e-6, found.imag, np.nan) / (2 * np.pi), axis=1)
    for i in range(int(np.isfinite(frequency).sum(axis=1).max(initial=0))):
        axes[0].plot(t, frequency[:, i], ".", color=COLOURS[i % len(COLOURS)], ms=2.5)
    axes[0].set_yscale("log")
    plain = plain_labels()
    axes[0].yaxis.set_major_formatter(plain)
    axes[0].yaxis.set_minor_formatter(plain)
    axes[0].set_ylabel("damped frequency [Hz]")
    axes[0].set_title("Frozen eigenvalues along the nominal motion")
    axes[1].plot(t, found.real, ".", color=COLOURS[0], ms=2.0)
    axes[1].plot(t, found.real.max(axis=1), color=COLOURS[1], lw=1.4, label="rightmost")
    axes[1].axhline(0, color=INK, lw=0.8)
    least = NOTHING * np.abs(found).max(initial=0.0)
    if np.abs(found.real).max(initial=0.0) < least:  # only rounding
        axes[1].set_ylim(-least, least)
    elif np.abs(found.real).max() > 1.0:
        axes[1].set_yscale("symlog", linthresh=1.0)
        decades = [s * 10.0**k for s in (-1, 1) for k in range(5)]
        low, high = axes[1].get_ylim()
        axes[1].set_yticks(sorted([0.0, *(d for d in decades if low <= d <= high)]))
    axes[1].set_ylabel("real part [1/s]")
    axes[1].set_xlabel("time [s]")
    axes[1].legend(loc="best")
    return figure

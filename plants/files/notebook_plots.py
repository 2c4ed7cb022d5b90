"""Pictures for notebooks: what `plot()` of a motion and a verdict and `bode()` of a linear model give.

Each is a matplotlib Figure that a notebook shows by itself and `figure.savefig("motion.png")` writes; no window opens
and no state of pyplot changes, but python-control's own in `bode`. The pictures of the commands are in
`studies.figures`.
"""

from __future__ import annotations

import io
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 7.0, 1.9  # [in] of a picture, of one of its panels


@cache
def _figures() -> type[Figure]:
    """Figures that a notebook shows; made when one is first drawn, as matplotlib is imported then."""
    from matplotlib.figure import Figure

    class NotebookFigure(Figure):
        def _repr_png_(self) -> bytes:
            buffer = io.BytesIO()
            self.savefig(buffer, format="png", dpi=110)
            return buffer.getvalue()

    return NotebookFigure


def _panels(count: int) -> tuple[Figure, list[Any]]:
    """Panels one above another."""
    figure = _figures()(figsize=(WIDTH, HEIGHT * count), layout="constrained")
    return figure, list(figure.subplots(count, 1, squeeze=False).flat)


class TrajectoryPlot:
    """A motion drawn."""

    def plot(self, *names: str) -> Figure:
        """States, inputs, outputs or disturbances over time [s], those of one unit in one panel; the outputs where none
        is named.

        ValueError for a name that the motion does not have.
        """
        motion: Any = self
        units = {s.name: s.unit for s in (*motion.disturbances, *motion.states, *motion.inputs, *motion.outputs)}
        wanted = names or tuple(s.name for s in motion.outputs or motion.states)
        columns = {name: motion[name] for name in wanted}
        kinds = list(dict.fromkeys(units[name] for name in columns))
        figure, axes = _panels(len(kinds))
        for ax, unit in zip(axes, kinds, strict=True):
            for name, column in columns.items():
                if units[name] == unit:
                    ax.plot(motion.t, column, label=name)
            ax.set_ylabel(f"[{unit}]" if unit else "")
            ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
            ax.grid(alpha=0.3)
        axes[-1].set_xlabel("time [s]")
        return figure


class ModelPlot:
    """A linear model drawn."""

    def bode(self, outputs: Any = None, **options: Any) -> Any:
        """python-control's Bode plot of the model: its ControlPlot, whose `figure` is the picture.

        outputs: None (the model's), "states", or names of outputs and states. options: of `control.bode_plot`, as
        `omega` [rad/s], `Hz`, `dB`. ValueError for a name that the model does not have.
        """
        import control

        model: Any = self
        return control.bode_plot(model.to_control(outputs=outputs), **options)


class VerdictPlot:
    """A verdict drawn."""

    def plot(self) -> Figure:
        """What the verdict rests on, over time [s]: how far the output that is pushed furthest may be off [its unit],
        growth of deviations [1], frozen real parts [1/s]; of a cycle its multipliers, of a constant model its roots.
        """
        told: Any = self
        found = told.evidence
        panels = [(told.horizon, _push), (found.get("growth"), _growth), (found.get("frozen_time"), _frozen)]
        panels += [(found.get("floquet"), _multipliers), (found.get("eigenvalues"), _roots)]
        drawn = [(what, draw) for what, draw in panels if what is not None]
        figure, axes = _panels(max(len(drawn), 1))
        for ax, (what, draw) in zip(axes, drawn):
            draw(ax, what)
            ax.grid(alpha=0.3)
        axes[0].set_title(told.verdict + (f" by {told.method}" if told.method else ""), loc="left")
        return figure


def _push(ax: Any, horizon: Any) -> None:
    worst = horizon.furthest
    low, high = horizon.tube[worst.name].T
    ax.fill_between(horizon.t_tube, low, high, alpha=0.3, label=horizon.limits_said)
    ax.set(xlabel="time [s]", ylabel=f"{worst.name}\n[{worst.unit}]")
    ax.legend(frameon=False, fontsize=8)


def _growth(ax: Any, grown: Any) -> None:
    ax.plot(grown.t, grown.curve)
    ax.axhline(1.0, color="0.4", lw=0.8)
    ax.set(xlabel="time [s]", ylabel="largest growth [1]", yscale="log")


def _frozen(ax: Any, frozen: Any) -> None:
    ax.plot(frozen.t, frozen.eigenvalues.real, ".", color="0.6", ms=2)
    ax.plot(frozen.t, frozen.rightmost)
    ax.set(xlabel="time [s]", ylabel="frozen real part\n[1/s]")


def _multipliers(ax: Any, cycle: Any) -> None:
    turn = np.linspace(0.0, 2 * np.pi, 200)
    ax.plot(np.cos(turn), np.sin(turn), color="0.6", lw=0.8)
    ax.plot(cycle.multipliers.real, cycle.multipliers.imag, "x")
    ax.set_aspect("equal", adjustable="datalim")
    ax.set(xlabel=f"multipliers over {cycle.period:.4g} s [1]")


def _roots(ax: Any, roots: Any) -> None:
    ax.plot(np.real(roots), np.imag(roots), "x")
    ax.axvline(0.0, color="0.4", lw=0.8)
    ax.set(xlabel="real part [1/s]", ylabel="imaginary part\n[rad/s]")

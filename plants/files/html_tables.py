"""Small tables for notebooks: what `_repr_html_` gives, without a style or script of its own."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from math import isfinite
from typing import Any

from .notebook_plots import ModelPlot, TrajectoryPlot, VerdictPlot

LONGEST = 12  # names told of one kind; more are counted


def html_table(title: str, rows: Iterable[tuple[str, Any]]) -> str:
    """A table of two columns under a title; what is empty is left out."""
    told = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(str(value))}</td></tr>"
        for name, value in rows
        if value not in ("", None)
    )
    return f"<table><caption>{escape(title)}</caption><tbody>{told}</tbody></table>"


def with_units(signals: Iterable[Any]) -> str:
    """Names with units, the first LONGEST."""
    found = [f"{s.name} [{s.unit}]" if s.unit else s.name for s in signals]
    return ", ".join(found[:LONGEST]) + (f" and {len(found) - LONGEST} more" if len(found) > LONGEST else "")


class PlantTable:
    """A plant in a notebook: its fidelity and its signals."""

    def _repr_html_(self) -> str:
        plant: Any = self
        kinds = ("states", "inputs", "outputs", "disturbances", "parameters")
        rows = [("fidelity", plant.label), *((kind, with_units(getattr(plant, kind))) for kind in kinds)]
        return html_table(type(self).__name__, rows)


class ModelTable(ModelPlot):
    """A linear model in a notebook: its signals and its slowest modes."""

    def _repr_html_(self) -> str:
        model: Any = self
        modes = [str(mode) for mode in model.modes()][:LONGEST]
        kinds = ("states", "inputs", "outputs", "disturbances")
        time = "continuous" if model.dt is None else f"sampled every {model.dt:g} s"
        rows = [
            ("time", time),
            *((kind, with_units(getattr(model, kind))) for kind in kinds),
            ("modes", "; ".join(modes)),
        ]
        return html_table(type(self).__name__, rows)


class TrajectoryTable(TrajectoryPlot):
    """A motion in a notebook: its times and the range of each output."""

    def _repr_html_(self) -> str:
        motion: Any = self
        rows = [("times", f"{len(motion.t)}, {motion.t[0]:g} to {motion.t[-1]:g} s")]
        for k, signal in enumerate(motion.outputs[:LONGEST]):
            y = motion.y[:, k]
            rows.append((signal.name, f"{y.min():.4g} to {y.max():.4g} {signal.unit}".strip()))
        return html_table(type(self).__name__, rows)


class VerdictTable(VerdictPlot):
    """A verdict in a notebook: the answer, why, and what else was tried."""

    def _repr_html_(self) -> str:
        told: Any = self
        rows = [
            ("verdict", told.verdict),
            ("by", told.method),
            ("why", told.why),
            ("drift of", ", ".join(told.drifting)),
        ]
        return html_table(type(self).__name__, [*rows, *told.reasons.items()])


def _bound(bound: float | None, unit: str) -> str:
    return f"at most {bound:.3g} {unit}" if bound is not None and isfinite(bound) else "no bound"


class ChoiceTable:
    """A choice in a notebook: the model, whether it was shown to do, and each rung's bound."""

    def _repr_html_(self) -> str:
        found: Any = self
        rows = [("model", found.plant.label), ("tolerance", f"{found.tolerance:g} {found.unit}")]
        rows.append(("shown to keep it", "yes" if found.met else "no"))
        rungs = [(rung.variant, _bound(rung.bound, found.unit)) for rung in found.rungs]
        return html_table(f"Choice for {found.scene}", [*rows, *rungs, ("missing", ", ".join(found.missing))])


class SceneTable:
    """A scene in a notebook: what it is about, its plant, times, goal and costs."""

    def _repr_html_(self) -> str:
        scene: Any = self
        goal = ", ".join(f"{name} = {value:g}" for name, value in scene.goal)
        times = f"{scene.duration:g} s in periods of {scene.dt:g} s"
        rows = [
            ("about", scene.about),
            ("plant", f"{type(scene.plant).__name__}, {scene.plant.label}"),
            ("time", times),
        ]
        return html_table(scene.name, [*rows, ("goal", goal), ("charged", ", ".join(scene.weighted))])

"""Which pictures the report has."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import Trajectory
from pliant.studies import figures
from pliant.studies.figures import arm_outline
from pliant.studies.figures.motion import snapshots

from .findings import Findings

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def figures_of(found: Findings) -> dict[str, Figure]:
    """The pictures by file name, in the page's order; one that cannot be drawn is told in `found.lost`."""
    made = {name: found.attempt(f"figure {name}", drawer) for name, drawer in _drawers(found).items()}
    return {name: figure for name, figure in made.items() if figure is not None}


def _drawers(found: Findings) -> dict[str, Callable[[], Figure | None]]:
    """What draws each picture, None where it has nothing to show."""
    scene = found.scene

    def regulated() -> list[tuple[str, Trajectory]]:
        return [(loop.name, loop.motion) for loop in found.loops if loop.motion is not None]

    def first() -> list[tuple[str, Trajectory]]:
        """Open loop, and the design plant's closed loop."""
        closed = [("LQR", loop.motion) for loop in found.loops[:1] if loop.motion is not None]
        return [("open loop", found.open_loop), *closed]

    def shapes() -> Figure | None:
        if arm_outline.in_space(scene.plant):
            return snapshots(scene, first())
        if not arm_outline.has_shape(scene.plant):
            return None
        cases = [(name, scene.plant, motion) for name, motion in first()]
        until = 1.2 * scene.move_time if scene.drive is None else arm_outline.first_turn(scene.plant, found.open_loop)
        draw = figures.strobe_in_space if scene.plant.drawn_as == "tree" else figures.stroboscopic
        return draw(cases, until=until)

    def tip_path() -> Figure | None:
        if not arm_outline.has_shape(scene.plant) or len(scene.compare) < 2:
            return None
        others = [(f"LQR, {name}", motion) for name, motion in regulated()]
        return figures.tip_path(scene, [("open loop", found.open_loop), *others])

    def eigenvalues() -> Figure:
        sets = [("open loop", found.goal.eigenvalues)]
        if found.law is not None:
            sets.append(("LQR, sampled", np.log(found.law.poles.astype(complex)) / scene.dt))
        return figures.eigenvalues(sets)

    def stability() -> Figure | None:
        told = found.judgement.found
        return None if told is None else figures.evidence(told, title="Along the motion", height=1.6)

    def controllers() -> Figure | None:
        played = any(contest.motion is not None for contest in found.contests)
        return figures.controllers(scene, found.contests) if played else None

    return {
        "motion": lambda: figures.histories(scene, [("open loop", found.nominal)], title="Open-loop motion"),
        "shapes": shapes,
        "tip_path": tip_path,
        "eigenvalues": eigenvalues,
        "stability": stability,
        "frozen_eigenvalues": lambda: figures.frozen(found.along) if found.judgement.found is None else None,
        "closed_loop": lambda: (
            figures.histories(scene, regulated(), title="LQR in closed loop") if regulated() else None
        ),
        "controllers": controllers,
        "speed_accuracy": lambda: figures.speed_accuracy(found.chart, mark=found.choice.integrator),
        "settings": lambda: figures.settings(found.chart),
        "ladder": lambda: figures.ladder(found.choice),
        "effects": lambda: figures.effects(found.choice, scene.times) if found.choice.effects else None,
    }

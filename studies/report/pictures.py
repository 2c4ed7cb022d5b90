"""Which pictures the report has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.studies import figures
from pliant.studies.figures import arm_outline
from pliant.studies.figures.motion import snapshots

from .findings import Findings

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def figures_of(found: Findings) -> dict[str, Figure]:
    """The pictures by file name, in the page's order."""
    scene = found.scene
    closed = [("LQR", loop.motion) for loop in found.loops[:1] if loop.motion is not None]
    drawn = {"motion": figures.histories(scene, [("open loop", found.nominal)], title="Open-loop motion")}
    if arm_outline.has_shape(scene.plant):
        cases = [(name, scene.plant, m) for name, m in (("open loop", found.open_loop), *closed)]
        until = 1.2 * scene.move_time if scene.drive is None else arm_outline.first_turn(scene.plant, found.open_loop)
        drawn["shapes"] = figures.stroboscopic(cases, until=until)
    if arm_outline.in_space(scene.plant):
        drawn["shapes"] = snapshots(scene, [("open loop", found.open_loop), *closed])
    runs = [(loop.name, loop.motion) for loop in found.loops if loop.motion is not None]
    if arm_outline.has_shape(scene.plant) and len(scene.compare) >= 2:
        drawn["tip_path"] = figures.tip_path(
            scene, [("open loop", found.open_loop), *((f"LQR, {name}", m) for name, m in runs)]
        )
    sets = [("open loop", found.goal.eigenvalues)]
    if found.law is not None:
        sets.append(("LQR, sampled", np.log(found.law.poles.astype(complex)) / scene.dt))
    drawn["eigenvalues"] = figures.eigenvalues(sets)
    if found.judgement.found is not None:
        drawn["stability"] = figures.evidence(found.judgement.found, title="Along the motion", height=1.6)
    else:
        drawn["frozen_eigenvalues"] = figures.frozen(found.along)
    if runs:
        drawn["closed_loop"] = figures.histories(scene, runs, title="LQR in closed loop")
    if any(contest.motion is not None for contest in found.contests):
        drawn["controllers"] = figures.controllers(scene, found.contests)
    drawn["speed_accuracy"] = figures.speed_accuracy(found.chart, mark=found.choice.integrator)
    drawn["settings"] = figures.settings(found.chart)
    drawn["ladder"] = figures.ladder(found.choice)
    if found.choice.effects:
        drawn["effects"] = figures.effects(found.choice, scene.times)
    return drawn

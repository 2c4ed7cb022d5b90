"""Everything that the report of a scene shows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.controllers import LQR
from pliant.envs.scenes.scene import Scene
from pliant.plants import LinearModel, LTVModel, Trajectory
from pliant.plants.core.signals import OwnsArrays, Signal
from pliant.studies.closed_loop.closed_loop import Loop
from pliant.studies.closed_loop.comparison import Contest
from pliant.studies.common import machine
from pliant.studies.fidelity.choice import Choice
from pliant.studies.fidelity.speed_accuracy import Chart
from pliant.studies.stability.judgement import Judgement


@dataclass
class Findings(OwnsArrays):
    """Everything that the report shows."""

    scene: Scene
    nominal: Trajectory  # open loop, at finer times
    open_loop: Trajectory  # the same at the control times
    goal: LinearModel
    along: LTVModel
    perturbed: Signal  # the coordinate that is perturbed to test that model
    ltv_errors: tuple[tuple[float, float, float], ...]  # perturbation, largest error and size of the prediction
    frequencies: tuple[tuple[str, np.ndarray], ...]  # variant, locked natural frequencies [Hz]
    law: LQR | None
    no_law: str  # why there is none, in the failure's words
    loops: tuple[Loop, ...]  # none without a law
    judgement: Judgement  # of stability along the motion
    contests: tuple[Contest, ...]  # controllers side by side, none without inputs
    chart: Chart
    choice: Choice
    scene_error: float  # of the scene's own plant against the finest variant
    machine: dict[str, str] = field(default_factory=machine.describe)
    seconds: float = 0.0

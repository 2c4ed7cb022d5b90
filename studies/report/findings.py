"""Everything that the report of a scene shows, found part by part: a part that fails is lost alone, with its reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.controllers import LQR
from pliant.envs.scenes.scene import Scene
from pliant.plants import LinearModel, LTVModel, PliantError, Trajectory
from pliant.plants.core.signals import OwnsArrays, Signal
from pliant.studies.closed_loop.closed_loop import Loop
from pliant.studies.closed_loop.comparison import Contest
from pliant.studies.common import machine
from pliant.studies.fidelity.choice import Choice
from pliant.studies.fidelity.speed_accuracy import Chart
from pliant.studies.stability.judgement import Judgement

FAULT = "a fault of Pliant's, please report it"


class Lost(PliantError):
    """A part that was not found; the message is the reason."""


@dataclass
class Findings(OwnsArrays):
    """Everything that the report shows. A field whose part failed raises Lost where it is asked for."""

    scene: Scene
    nominal: Trajectory = field(init=False)  # open loop, at finer times
    open_loop: Trajectory = field(init=False)  # the same at the control times
    goal: LinearModel = field(init=False)
    along: LTVModel = field(init=False)
    perturbed: Signal = field(init=False)  # the coordinate that is perturbed to test that model
    ltv_errors: tuple[tuple[float, float, float], ...] = field(init=False)  # perturbation, largest error, prediction
    frequencies: tuple[tuple[str, np.ndarray], ...] = field(init=False)  # variant, locked natural frequencies [Hz]
    unheld: tuple[tuple[str, str], ...] = field(init=False)  # variants without frequencies, why
    law: LQR | None = field(init=False)
    no_law: str = field(init=False)  # why there is none, in the failure's words
    loops: tuple[Loop, ...] = field(init=False)  # none without a law
    judgement: Judgement = field(init=False)  # of stability along the motion
    contests: tuple[Contest, ...] = field(init=False)  # controllers side by side, none without inputs
    chart: Chart = field(init=False)
    choice: Choice = field(init=False)
    unasked: tuple[str, ...] = ()  # controllers whose motions the choice was not asked for, for want of time
    scene_error: float = field(init=False)  # of the scene's own plant against physics
    machine: dict[str, str] = field(default_factory=machine.describe)
    seconds: float = 0.0
    lost: dict[str, str] = field(default_factory=dict)  # by field, section, picture or table: why it is not there

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Of a field that was not found."""
            lost = self.__dict__.get("lost", {})
            raise Lost(lost[name]) if name in lost else AttributeError(f"Findings has no {name!r}")

    def find(self, name: str, part: Callable[[], Any]) -> None:
        """A field's value; where `part` fails, the field is lost."""
        value = self.attempt(name, part)
        if name not in self.lost:
            setattr(self, name, value)

    def attempt(self, name: str, part: Callable[[], Any]) -> Any:
        """What `part` gives; None where it fails, and then `lost` says why. This is where the report survives."""
        try:
            return part()
        except PliantError as failure:
            kind = "" if isinstance(failure, Lost) else f"{type(failure).__name__}: "
            self.lost[name] = f"{kind}{failure}"
        except Exception as fault:  # one part's fault must not take the others along
            self.lost[name] = f"{type(fault).__name__}: {fault} ({FAULT})"
        return None

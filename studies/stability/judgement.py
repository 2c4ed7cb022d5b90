"""The stability verdict along a scene's motion within a few seconds, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.plants.core.argument_gates import require_function, require_instance, require_number
from pliant.plants.stability import Verdict
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Progress, silent

from .over_ranges import over_ranges
from .verdicts import left_out, model_along, verdict_along, verdict_at_goal

SECONDS = 8.0  # for the motion and its linear model
LARGEST = 12e6  # nodes times states cubed above which the verdict itself would take some seconds more


class _Late(Exception):
    """The time is spent."""


@dataclass(frozen=True, eq=False)
class Judgement:
    """What `pliant stability` says of a scene."""

    found: Verdict | None
    left_out: tuple[str, ...] = ()  # states without a part in it
    at_the_goal: Verdict | None = None  # about the goal as an equilibrium; None where it is none or moves
    reason: str = ""  # why there is no verdict
    over_ranges: str = ""  # what LQR stands of the scene's ranges; "" where nothing is told

    def to_json(self) -> dict[str, Any]:
        return {
            **(self.found.to_json() if self.found is not None else {"verdict": None}),
            "left_out": list(self.left_out),
            "at_the_goal": None if self.at_the_goal is None else self.at_the_goal.to_json(),
            "over_ranges": self.over_ranges or None,
            "reason": self.reason or None,
        }


def judge(
    scene: Scene, *, seconds: float = SECONDS, largest: float = LARGEST, progress: Progress | None = None
) -> Judgement:
    """The verdict along the nominal motion; none where that fails or takes over `seconds` [s] of processor time.

    largest: nodes times states cubed, to which the work of the verdict itself is proportional; beyond it there is none.
    """
    require_instance("judge.scene", scene, Scene)
    seconds = require_number("judge.seconds", seconds, "nonnegative", "s")
    largest = require_number("judge.largest", largest, "positive")
    if progress is not None:
        require_function("judge.progress", progress)
    told, began = progress or silent, processor_time()

    def tell(fraction: float, doing: str) -> None:
        if processor_time() - began > seconds:
            raise _Late
        told(fraction, doing)

    try:
        goal = verdict_at_goal(scene)
    except PliantError:  # the goal is no equilibrium of this plant
        goal = None
    try:
        model = model_along(scene, tell)
    except _Late:
        return Judgement(
            None, (), goal, f"cut off: the motion and its linear model took more than {seconds:g} s of processor time"
        )
    except PliantError as failure:
        return Judgement(None, (), goal, f"{type(failure).__name__}: {failure}")
    out = left_out(scene.plant, model)
    kept = len(model.states) - len(out)
    if len(model.t) * kept**3 > largest:
        why = f"cut off: {len(model.t)} nodes of {kept} states would take too long"
        return Judgement(None, out, goal, why)
    told(0.8, "verdict")
    found = verdict_along(scene, model)
    told(1.0, found.verdict)
    return Judgement(found, out, goal, over_ranges=over_ranges(scene))

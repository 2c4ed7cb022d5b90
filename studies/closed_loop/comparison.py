"""LQR, MPC and the trained policy side by side, from the scene's start, on its plant and on the finest varied one.

Played by adaptive integration as in closed_loop.py, with true readings, on plants whose functions are built already:
a few runs are cheaper so than by the fixed steps of rollout.py, which many runs repay. What a run is charged that
leaves the scene's bounds is the same there.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.controllers import LQR, Controller
from pliant.controllers.learning.policy import shipped
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.episode_start import early_end_cost
from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.signals import names
from pliant.studies.common.reference_motions import Progress, silent

from .closed_loop import Loop, dearer, end_error, run
from .contestants import CONTESTANTS, Designed, designed, in_one_line
from .evaluation_scene import require_signals
from .rollout import Rollout
from .scores import deflections, score

HORIZON = 20  # [control periods] of the MPC
POLICY = "trained policy"


@dataclass(frozen=True)
class Contest:
    """One controller on one plant. None where there is nothing to tell."""

    controller: str
    plant: str
    states: int
    reads: tuple[str, ...] = ()
    cost: float | None = None  # with the charge for an early end
    final_error: float | None = None  # largest of the signals `driven_to_goal` at the end [their unit]
    peak: float | None = None  # [m] largest deflection
    at_limit: float | None = None  # share of the control periods with an input at its limit
    acts: int | None = None  # of the MPC, and how many ..
    violations: int | None = None  # .. predicted that a bound is exceeded, by its own record
    unsolved: int | None = None  # .. had no solution, so that an earlier plan went on
    failure: str = ""  # why there was no run, or why it ended early
    motion: Trajectory | None = field(default=None, repr=False)

    def to_json(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "motion"}


def compare(
    scene: Scene,
    law: LQR | None = None,
    loops: Sequence[Loop] = (),
    *,
    progress: Progress | None = None,
) -> tuple[Contest, ...]:
    """Every controller on the scene's plant, then every one on the finest varied plant.

    law, loops: the LQR and its runs where `closed_loop` has made them, on the scene's plant first and on the finest
    varied one last. The trained policy only on scenes for which one is shipped.
    """
    told = progress or silent
    made: dict[str, Controller | str] = {"LQR": law if law is not None else designed(scene, CONTESTANTS["LQR"])}
    made["MPC"] = designed(scene, Designed("MPC", (("horizon", HORIZON),)))
    if scene.name in shipped():
        made[POLICY] = designed(scene, CONTESTANTS[POLICY])
    plants = tuple(dict.fromkeys((scene.plant, dearer(scene.plant))))
    played: list[tuple[Scene, Trajectory | str | None]] = [(scene.with_plant(plant), None) for plant in plants]
    if loops and law is not None:
        known = ((loop.motion or loop.failure) for loop in (loops[0], loops[-1]))
        played = [(on, told_of) for (on, _), told_of in zip(played, known)]
    found = []
    for i, (on, motion) in enumerate(played):
        for k, (name, controller) in enumerate(made.items()):
            told((i + k / len(made)) / len(played), f"{name} on {on.plant.label}")
            found.append(_contest(scene, on, name, controller, motion if name == "LQR" else None))
    told(1.0, "controllers")
    return tuple(found)


def _contest(
    scene: Scene, played: Scene, name: str, controller: Controller | str, motion: Trajectory | str | None
) -> Contest:
    """`motion`: the run where it is at hand, or why there is none."""
    plant = played.plant
    found = Contest(name, plant.label, plant.nx)
    if isinstance(controller, str):
        return dataclasses.replace(found, failure=controller)
    found = dataclasses.replace(found, reads=tuple(controller.reads))
    if motion is None:
        try:
            require_signals(controller.reads, scene, played)
            controller.reset()
            motion = run(played, controller)
        except (PliantError, ValueError) as failure:
            return dataclasses.replace(found, failure=in_one_line(failure))
    if isinstance(motion, str):
        return dataclasses.replace(found, failure=motion)
    record = getattr(controller, "record", None)
    if record is not None:
        counts = {"acts": record.calls, "violations": record.violations, "unsolved": record.failures}
        found = dataclasses.replace(found, **counts)
    ended = ending(played, motion)
    told = score(played, ended)
    shown = motion if not ended.failure else _until(motion, len(ended.t), plant)
    return dataclasses.replace(
        found,
        cost=told.cost,
        final_error=None if ended.failure else end_error(scene, motion),
        peak=_peak(played, shown),
        at_limit=told.at_limit,
        failure=ended.failure,
        motion=shown,
    )


def ending(scene: Scene, motion: Trajectory) -> Rollout:
    """The motion, sampled at the scene's control times, up to where it leaves the scene's bounds, and its cost.

    The cost is the scene's of each period, and what the environment charges for the time that is left.
    """
    sizes = [np.abs(motion[name]) / bound for name, bound in scene.bounds]
    over = np.max(sizes, axis=0) > 1.0 if sizes else np.zeros(len(motion.t), dtype=bool)
    over[0] = False  # a start out of bounds is the scene's
    done, failure = scene.steps, ""
    periods = scene.dt * scene.stage_cost(motion.x, motion.u, motion.y, motion.t - motion.t[0])[:-1]
    cost = float(periods.sum())
    if over.any():
        done = int(np.argmax(over))
        name, bound = scene.bounds[int(np.argmax([size[done] for size in sizes]))]
        failure = f"{name} beyond its bound {bound:g} at {motion.t[done]:.4g} s"
        cost = float(periods[:done].sum() + early_end_cost(scene, done, periods[done - 1]))
    signals, u = np.hstack([motion.x, motion.y])[: done + 1], motion.u[:done]
    calls = np.zeros(done, dtype=np.int64)
    return Rollout(motion.t[: done + 1], signals, u, u, cost, failure, calls, names(scene.signals))


def _peak(scene: Scene, motion: Trajectory) -> float | None:
    """[m] largest deflection."""
    return max((float(np.abs(motion[name]).max()) for name in deflections(scene)), default=None)


def _until(motion: Trajectory, count: int, plant: Plant) -> Trajectory:
    """The first `count` samples."""
    return Trajectory.from_arrays(motion.t[:count], motion.x[:count], motion.u[:count], plant=plant, y=motion.y[:count])

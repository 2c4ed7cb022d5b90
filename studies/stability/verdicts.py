"""The stability verdict along a scene's nominal motion, and about its goal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import LinearModel, LTVModel, Plant, Trajectory
from pliant.plants.core.argument_gates import require_function, require_instance
from pliant.plants.core.signals import Unfelt
from pliant.plants.stability import Verdict, assess
from pliant.studies.common.operating_point import residual
from pliant.studies.common.reference_motions import Progress, silent

POINTS = 401  # nodes of the nominal at least
ROUNDING = 1e-12  # of the largest entry of A


def verdict_of(scene: Scene, *, progress: Progress | None = None, **options: Any) -> tuple[Verdict, LTVModel]:
    """The verdict along the scene's nominal motion, and the model; options as in `assess`. See `left_out`."""
    require_instance("verdict_of.scene", scene, Scene)
    if progress is not None:
        require_function("verdict_of.progress", progress)
    tell = progress or silent
    model = model_along(scene, tell)
    tell(0.8, "verdict")
    found = verdict_along(scene, model, **options)
    tell(1.0, found.verdict)
    return found, model


def model_along(scene: Scene, tell: Progress) -> LTVModel:
    """The linear model along the scene's nominal motion; what `tell` raises ends it."""
    motion = _nominal(scene, lambda t: tell(0.7 * min(t / scene.duration, 1.0), f"{t:.2f} s"))
    tell(0.7, "linear model")
    return _linear(scene.plant, lambda **own: scene.plant.linearize_along(motion, **own))


def verdict_along(scene: Scene, model: LTVModel, **options: Any) -> Verdict:
    """`assess` of that model, told what has no part in its stability and which outputs the scene compares."""
    return assess(model, **{"outputs": scene.compare, **_parts(scene.plant, model), **options})


def verdict_at_goal(scene: Scene) -> Verdict | None:
    """The verdict about the goal as a LinearModel, None where it is no equilibrium or moves."""
    require_instance("verdict_at_goal.scene", scene, Scene)
    if scene.goal_rates or residual(scene.goal_model):
        return None
    model = _linear(scene.plant, lambda **own: scene.plant.linearize(*scene.target, **own))
    return assess(model, **_parts(scene.plant, model))


def _nominal(scene: Scene, progress: Callable[[float], None]) -> Trajectory:
    """The nominal motion with nodes enough; of a goal that moves steadily the goal's own."""
    motion = scene.goal_motion() if scene.goal_rates else scene.nominal_motion(progress=progress)
    if len(motion.t) < POINTS:
        motion = motion.resample(np.linspace(motion.t[0], motion.t[-1], POINTS))
    return motion


def _linear(plant: Plant, linearize: Callable[..., Any]) -> Any:
    """The linear model; of a spacecraft that does not feel its attitude in body rates instead of turns.

    Turns measured from an attitude that turns show a growth that is theirs alone.
    """
    if plant.attitude_states:
        own = linearize(attitude="quaternion")
        if set(plant.attitude_states) <= set(left_out(plant, own)):
            return own
    return linearize()


def left_out(plant: Plant, model: LTVModel | LinearModel) -> tuple[str, ...]:
    """The states of the model that have no part in its stability, of those that the plant says may have none.

    A spacecraft's position and attitude where the rest does not feel them, hinges whose motion is given, wheels that
    nothing turns.
    """
    may = plant.unfelt
    if may == Unfelt():
        return ()
    known = [s.name for s in model.states]
    A = np.abs(model.A).reshape(-1, len(known), len(known)).max(axis=0)
    nothing = ROUNDING * A.max()
    out = {*may.given}
    out |= {name for k, name in enumerate(known) if name in may.stored and A[k].max() <= nothing}
    for group in may.groups:
        columns = [k for k, name in enumerate(known) if name in group]
        rest = [k for k, name in enumerate(known) if name not in group and name not in out]
        if columns and A[np.ix_(rest, columns)].max() <= nothing:
            out |= {known[k] for k in columns}
    return tuple(name for name in known if name in out)


def _parts(plant: Plant, model: LTVModel | LinearModel) -> dict[str, Any]:
    """What `assess` is told of states and coordinates."""
    out = left_out(plant, model)
    if not out:
        return {}
    kept = tuple(s.name for s in model.states if s.name not in out)
    if not plant.attitude_states:
        return {"states": kept}
    turns = not set(plant.attitude_states) & set(out)
    words = "turns from the nominal attitude" if turns else "body rates in hub axes"
    return {"states": kept, "coordinates": f"{words}, hinge and elastic coordinates"}

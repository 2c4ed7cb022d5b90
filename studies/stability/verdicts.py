"""`pliant stability SCENE`: the verdict along a scene's nominal motion."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.plants.core.signals import Unfelt
from pliant.studies.common.console import bar, scene_with, show

if TYPE_CHECKING:
    from pliant.envs.scenes.scene import Scene
    from pliant.plants import LinearModel, LTVModel, Plant, Trajectory
    from pliant.plants.stability import Verdict
    from pliant.studies.common.reference_motions import Progress

POINTS = 401  # nodes of the nominal at least
ROUNDING = 1e-12  # of the largest entry of A


def stability(
    scene: Annotated[str, typer.Argument(help="A scene's name; `pliant scenes` lists them.")],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Change the plant or the scene, as in `pliant simulate`."),
    ] = None,
    period: Annotated[float | None, typer.Option(help="Period [s] of the nominal; found if not given.")] = None,
    repeated: Annotated[
        bool, typer.Option("--repeated/--once", help="Whether a nominal that closes counts as a period.")
    ] = True,
    window: Annotated[float | None, typer.Option(help="Window [s] of the growth; a tenth if not given.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw into this file: png, svg or pdf.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Write JSON to stdout in place of the table.")] = False,
) -> None:
    """Say whether deviations from a scene's nominal motion grow, by which method, and where no method can tell."""
    from pliant.studies.common.atomic_files import dumps

    chosen = scene_with(scene, settings or [])
    found, model = verdict_of(chosen, period=period, periodic=None if repeated else False, window=window)
    out, goal = left_out(chosen.plant, model), verdict_at_goal(chosen)
    if plot is not None:
        from pliant.studies.figures.stability import evidence
        from pliant.studies.figures.style import save

        save(evidence(found, title=chosen.name), plot)
    if as_json:
        told = {"scene": chosen.name, "plant": chosen.plant.label, "left_out": list(out)}
        print(dumps({**told, **found.to_json(), "at_the_goal": None if goal is None else goal.to_json()}))
        return
    caption = f"{chosen.plant.label}; frozen roots in {found.coordinates}"
    if out:
        caption += f"; left out, as the rest does not feel them or nothing moves them: {', '.join(out)}"
    if found.critical_times:
        caption += "; critical times " + ", ".join(f"{t:.3g}" for t in found.critical_times[:10]) + " s"
    head = f"{chosen.name}: {found.verdict}" + (f" by {found.method}" if found.method else "")
    show(head, ("method", "role", "what it says"), found.rows(), caption=caption)
    if goal is not None:
        print(f"About the goal alone, which is an equilibrium: {goal.verdict}; {goal.why}.")


def verdict_of(scene: Scene, **options: Any) -> tuple[Verdict, LTVModel]:
    """The verdict along the scene's nominal motion, and the model; options as in `assess`. See `left_out`."""
    with bar(f"stability {scene.name}") as tell:
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
    """`assess` of that model, told what has no part in its stability."""
    from pliant.plants.stability import assess

    return assess(model, **_parts(scene.plant, model), **options)


def verdict_at_goal(scene: Scene) -> Verdict | None:
    """The verdict about the goal as a LinearModel, None where it is no equilibrium or moves."""
    from pliant.plants.stability import assess
    from pliant.studies.common.operating_point import residual

    if scene.goal_rates or residual(scene.goal_model):
        return None
    model = _linear(scene.plant, lambda **own: scene.plant.linearize(*scene.target, **own))
    return assess(model, **_parts(scene.plant, model))


def _nominal(scene: Scene, progress: Callable[[float], None]) -> Trajectory:
    """The nominal motion with nodes enough; of a goal that moves steadily the goal's own."""
    import numpy as np

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
    import numpy as np

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

"""`pliant stability SCENE`: the answer along a scene's nominal motion, its numbers, its picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.envs.scene_files.settings import with_settings
from pliant.plants.core.argument_gates import LEAST, require_seconds
from pliant.studies.figures.stability import evidence
from pliant.studies.figures.style import save
from pliant.studies.stability.over_ranges import over_ranges
from pliant.studies.stability.verdicts import left_out, verdict_at_goal, verdict_of

from .console import bar, drawable, print_json, say, show
from .options import AsJson, Picture, SceneName, Settings


def stability(
    scene: SceneName,
    settings: Settings = None,
    period: Annotated[float | None, typer.Option(help="Period [s] of the nominal; found if not given.")] = None,
    repeated: Annotated[
        bool, typer.Option("--repeated/--once", help="Whether a nominal that closes counts as a period.")
    ] = True,
    window: Annotated[float | None, typer.Option(help="Window [s] of the growth; a tenth if not given.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Say how far disturbances push a scene's nominal motion, and whether deviations from it die out or grow.

    The picture goes to SCENE-stability.png where --plot names no other.
    """
    chosen = with_settings(scene, settings or [])
    period = None if period is None else require_seconds("--period", period, LEAST)
    window = None if window is None else require_seconds("--window", window, LEAST)
    picture = plot or (None if as_json else Path(f"{chosen.name}-stability.png"))
    drawable(picture)
    options = {"period": period, "periodic": None if repeated else False, "window": window}
    with bar(f"stability {chosen.name}") as tell:
        found, model = verdict_of(chosen, progress=tell, **options)
    out, goal, ranges = left_out(chosen.plant, model), verdict_at_goal(chosen), over_ranges(chosen)
    if picture is not None:
        save(evidence(found, title=chosen.name), picture)
    if as_json:
        told = {"scene": chosen.name, "plant": chosen.plant.label, "left_out": list(out)}
        print_json(
            {
                **told,
                **found.to_json(),
                "over_ranges": ranges or None,
                "at_the_goal": None if goal is None else goal.to_json(),
            }
        )
        return
    caption = f"{chosen.plant.label}; frozen roots in {found.coordinates}"
    if out:
        caption += f"; left out, as the rest does not feel them or nothing moves them: {', '.join(out)}"
    if found.critical_times:
        caption += "; critical times " + ", ".join(f"{t:.3g}" for t in found.critical_times[:10]) + " s"
    head = f"{chosen.name}: {found.verdict}" + (f" by {found.method}" if found.method else "")
    say(found.sentence)
    if ranges:
        say(ranges)
    if found.horizon is None:
        say(f"No numbers of the motion: {found.no_horizon}.")
    else:
        names = ", ".join(found.horizon.limits)
        columns = ("output", "unit energy", "attained", found.horizon.limits_said, "attained", "at")
        show(f"{chosen.name}: how far it is pushed", columns, found.horizon.rows(), caption=f"bounds, by {names}")
    show(head, ("method", "role", "what it says"), found.rows(), caption=caption)
    if goal is not None:
        say(f"About the goal alone, which is an equilibrium: {goal.verdict}; {goal.why}.")
    if picture is not None:
        say(f"Picture: {picture}")

"""`pliant stability SCENE`: the answer along a scene's nominal motion, its numbers, its picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from pliant.envs.scene_files.settings import with_settings
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import LEAST, require_seconds
from pliant.studies.figures.stability import evidence
from pliant.studies.figures.style import save
from pliant.studies.stability import turning
from pliant.studies.stability.campbell_picture import campbell_diagram
from pliant.studies.stability.over_ranges import over_ranges
from pliant.studies.stability.verdicts import left_out, verdict_at_goal, verdict_of

from .console import bar, drawable, print_json, say, show
from .options import AsJson, Picture, SceneName, Settings


def stability(
    scene: SceneName,
    settings: Settings = None,
    period: Annotated[float | None, typer.Option(help="Period in s of the nominal; found if not given.")] = None,
    repeated: Annotated[
        bool, typer.Option("--repeated/--once", help="Whether a nominal that closes counts as a period.")
    ] = True,
    window: Annotated[float | None, typer.Option(help="Window in s of the growth; a tenth if not given.")] = None,
    campbell: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="LOW HIGH", help="Modes over these speeds, in rad/s, of a machine that turns, instead."),
    ] = None,
    tongues: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="LOW HIGH", help="Crank speeds, in rad/s, at which a cycle is unstable, instead."),
    ] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Say how far disturbances push a scene's nominal motion, and whether deviations from it die out or grow.

    The picture goes to SCENE-stability.png where --plot names no other.
    """
    chosen = with_settings(scene, settings or [])
    if campbell is not None and tongues is not None:
        raise ValueError("--campbell and --tongues are two answers: give one of them")
    if tongues is not None:
        _tongues(chosen, tongues, as_json)
        return
    if campbell is not None:
        _campbell(chosen, campbell, plot or (None if as_json else Path(f"{chosen.name}-campbell.png")), as_json)
        return
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
        trust = "" if found.horizon.trusted else "; beyond where the linear model can be trusted"
        columns = ("output", "unit energy", "attained", found.horizon.limits_said, "attained", "at")
        show(
            f"{chosen.name}: how far it is pushed", columns, found.horizon.rows(), caption=f"bounds, by {names}{trust}"
        )
    show(head, ("method", "role", "what it says"), found.rows(), caption=caption)
    if goal is not None:
        say(f"About the goal alone, which is an equilibrium: {goal.verdict}; {goal.why}.")
    if picture is not None:
        say(f"Picture: {picture}")


def _campbell(scene: Scene, speeds: tuple[float, float], picture: Path | None, as_json: bool) -> None:
    """The diagram: frequencies at both ends, and the speeds at which a multiple of the speed meets a mode."""
    drawable(picture)
    found = turning.campbell_of(scene, *speeds)
    if picture is not None:
        save(campbell_diagram(found, title=scene.name), picture)
    if as_json:
        modes = {"speeds": found.speeds, "frequencies": found.frequencies, "rates": found.rates}
        crossings = [{"order": c.order, "mode": c.mode + 1, "speed": c.speed} for c in found.crossings]
        print_json({"scene": scene.name, "speed": turning.speed_of(scene), **modes, "crossings": crossings})
        return
    ends = [
        (k + 1, *(float(found.frequencies[at, k]) / (2 * np.pi) for at in (0, -1)))
        for k in range(found.frequencies.shape[1])
    ]
    head = ("mode", f"Hz at {found.speeds[0]:.4g} rad/s", f"Hz at {found.speeds[-1]:.4g} rad/s")
    show(f"{scene.name}: modes over {turning.speed_of(scene)}", head, ends)
    meets = [(f"{c.order}x", c.mode + 1, c.speed, c.speed * 30 / np.pi) for c in found.crossings]
    if meets:
        show("where a multiple of the speed meets a mode", ("multiple", "mode", "rad/s", "rpm"), meets)
    else:
        say("No multiple of the speed up to four times meets a mode.")
    if picture is not None:
        say(f"Picture: {picture}")


def _tongues(scene: Scene, speeds: tuple[float, float], as_json: bool) -> None:
    found = turning.tongues_of(scene, *speeds)
    if as_json:
        print_json({"scene": scene.name, "tongues": [t._asdict() for t in found]})
        return
    if not found:
        say(f"{scene.name}: no unstable cycle was found between {speeds[0]:g} and {speeds[1]:g} rad/s.")
        return
    rows = [(t.low, t.high, t.peak, t.growth) for t in found]
    head = ("from rad/s", "to rad/s", "fastest at", "growth 1/s")
    show(f"{scene.name}: crank speeds at which the cycle is unstable", head, rows, caption="edges to 1e-4 rad/s")

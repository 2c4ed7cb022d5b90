"""`pliant stability SCENE`: the verdict along a scene's nominal motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .console import bar, scene_with, show

if TYPE_CHECKING:
    from pliant.envs.scenes import Scene
    from pliant.plants import LTVModel
    from pliant.plants.stability import Verdict

POINTS = 401  # nodes of the nominal at least


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
    from .files import dumps

    chosen = scene_with(scene, settings or [])
    found, _ = verdict_of(chosen, period=period, periodic=None if repeated else False, window=window)
    if plot is not None:
        from .stability_figures import evidence
        from .style import save

        save(evidence(found, title=chosen.name), plot)
    if as_json:
        print(dumps({"scene": chosen.name, "plant": chosen.plant.label, **found.to_json()}))
        return
    caption = f"{chosen.plant.label}; frozen roots in {found.coordinates}"
    if found.critical_times:
        caption += "; critical times " + ", ".join(f"{t:.3g}" for t in found.critical_times[:10]) + " s"
    head = f"{chosen.name}: {found.verdict}" + (f" by {found.method}" if found.method else "")
    show(head, ("method", "role", "what it says"), found.rows(), caption=caption)


def verdict_of(scene: Scene, **options: Any) -> tuple[Verdict, LTVModel]:
    """The verdict along the scene's nominal motion, and the model; options as in `assess`."""
    from pliant.plants.stability import assess

    with bar(f"stability {scene.name}") as tell:
        motion = scene.open_loop(progress=lambda t: tell(0.7 * min(t / scene.duration, 1.0), f"{t:.2f} s"))
        if len(motion.t) < POINTS:
            import numpy as np

            motion = motion.resample(np.linspace(motion.t[0], motion.t[-1], POINTS))
        tell(0.7, "linear model")
        model = scene.plant.linearize_along(motion)
        tell(0.8, "verdict")
        found = assess(model, **options)
        tell(1.0, found.verdict)
    return found, model

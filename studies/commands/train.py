"""Train a policy on a scene with a progress bar, and draw how its cost fell, beside that of the scene's LQR."""

from __future__ import annotations

import dataclasses
import shlex
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from pliant.controllers import rl
from pliant.controllers.learning.evaluation import Training
from pliant.controllers.learning.settings import APGSettings
from pliant.envs.scene_files.settings import with_settings
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.studies.closed_loop.closed_loop import regulator
from pliant.studies.closed_loop.evaluation_scene import harsher
from pliant.studies.figures import style
from pliant.studies.figures.controllers import learning_curve
from pliant.studies.scene_pages.returns import charged

from .console import bar, complain, print_json, say, writable_folder
from .options import AsJson, SceneName, Settings

PICTURE = "curve.png"
HARSH = APGSettings(delay=1, noise=0.01)  # of --robust, beside what the scene is then varied by


def draw(scene: Scene, algorithm: str, found: Training, folder: Path) -> None:
    """curve.png of a run: its costs beside the scene's LQR."""
    style.save(learning_curve(scene, algorithm, found.curve, lqr_cost(scene)), folder / PICTURE)


def lqr_cost(scene: Scene) -> float | None:
    """The cost of the scene's LQR, torques cut off at the limits, charged for the time left where it leaves the bounds;
    None where there is no such regulator.
    """
    try:
        law = regulator(scene)
        motion = scene.plant.simulate(scene.initial[0], law, scene.times, rtol=1e-8, atol=1e-10)
    except PliantError:
        return None
    return charged(scene, motion)


def table(found: Training, lqr: float | None) -> dict[str, Any]:
    """What `pliant train --json` prints."""
    return {
        "scene": found.policy.scene,
        "cost": found.cost,
        "lqr_cost": lqr,
        "words": found.words,
        "steps": found.steps,
        "seconds": found.seconds,
        "steps_per_second": found.rate,
        "threads": found.threads,
        "curve": [dataclasses.asdict(point) for point in found.curve],
    }


def command(
    scene: SceneName,
    settings: Settings = None,
    algorithm: Annotated[
        Literal["apg", "ppo", "sac"] | None,
        typer.Option(help="Who learns: exact gradients (apg), or reinforcement learning.", show_default="apg"),
    ] = None,
    robust: Annotated[
        bool, typer.Option("--robust", help="Learn under delay, noise and +-30 % of parameters, one fidelity higher.")
    ] = False,
    seed: Annotated[int, typer.Option(help="Of everything drawn at random.")] = 0,
    seconds: Annotated[float | None, typer.Option(help="Time it may take; if nothing is said 60 (apg) or 300.")] = None,
    steps: Annotated[int | None, typer.Option(help="Environment steps, in place of a time.")] = None,
    num_envs: Annotated[int | None, typer.Option(help="Lanes; the algorithm's own number if not given.")] = None,
    threads: Annotated[int | None, typer.Option(help="Of torch; measured if not given.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write; trained/SCENE if not given.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the folder's checkpoint.")] = False,
    as_json: AsJson = False,
) -> None:
    """Learn to play a scene: a policy as arrays and JSON, its evaluation curve, a checkpoint to go on from."""
    chosen = with_settings(scene, settings or [])
    folder = Path("trained") / chosen.name if out is None else out
    writable_folder("--out", folder)
    words = ["pliant", "train", scene, *(w for s in settings or [] for w in ("--set", s))]
    words += ["--robust"] if robust else []
    given = {
        "--algorithm": algorithm,
        "--seed": seed,
        "--seconds": seconds,
        "--steps": steps,
        "--num-envs": num_envs,
        "--threads": threads,
    }
    words += [w for key, value in given.items() if value is not None for w in (key, str(value))]
    try:
        with bar(f"train {chosen.name}") as tell:
            found = rl.train(
                harsher(chosen) if robust else chosen,
                "apg" if robust else algorithm,
                seed=seed,
                seconds=seconds,
                steps=steps,
                num_envs=num_envs,
                folder=folder,
                resume=resume,
                threads=threads,
                settings=HARSH if robust else None,
                command=shlex.join(words),
                progress=tell,
            )
    except ImportError as error:
        complain(str(error))
        raise typer.Exit(1) from None
    draw(chosen, str(found.policy.made["algorithm"]), found, folder)
    lqr = lqr_cost(chosen)
    if as_json:
        print_json(table(found, lqr))
        return
    beside = f", {found.cost / lqr:.3g} times LQR's {lqr:.4g}" if lqr else ""
    say(f"cost {found.cost:.4g}{beside}")
    if found.words:
        say(found.words)
    say(f"{found.steps:,} steps in {found.seconds:.0f} s, {found.rate:,.0f} steps/s; {found.threads}")
    print(folder)

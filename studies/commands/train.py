"""Train a policy on a scene with a progress bar, and draw how its cost fell, beside that of the scene's LQR."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from pliant.controllers import rl
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.studies.closed_loop.closed_loop import regulator
from pliant.studies.common.console import bar
from pliant.studies.figures import style

if TYPE_CHECKING:
    from pliant.controllers.learning.evaluation import Evaluation, Training
    from pliant.controllers.learning.settings import PPOSettings, SACSettings

PICTURE = "curve.png"


def train(
    scene: Scene,
    algorithm: str = "ppo",
    *,
    seed: int = 0,
    seconds: float | None = None,
    steps: int | None = None,
    num_envs: int | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    threads: int | None = None,
    settings: PPOSettings | SACSettings | None = None,
    command: str = "",
) -> Training:
    """`pliant.controllers.rl.train` with a bar on stderr, and curve.png in the folder."""
    with bar(f"train {scene.name}") as tell:
        found = rl.train(
            scene,
            algorithm,
            seed=seed,
            seconds=seconds,
            steps=steps,
            num_envs=num_envs,
            folder=folder,
            resume=resume,
            threads=threads,
            settings=settings,
            command=command,
            progress=tell,
        )
    if folder is not None:
        style.save(draw(scene, algorithm, found.curve, lqr_cost(scene)), Path(folder) / PICTURE)
    return found


def lqr_cost(scene: Scene) -> float | None:
    """The cost of the scene's LQR, torques cut off at the limits; None where there is no such regulator."""
    try:
        law = regulator(scene)
        motion = scene.plant.simulate(scene.initial[0], law, scene.times, rtol=1e-8, atol=1e-10)
    except PliantError:
        return None
    return scene.cost(motion)


@style.styled
def draw(scene: Scene, algorithm: str, curve: Sequence[Evaluation], lqr: float | None) -> Figure:
    """Cost of the deterministic policy against training steps."""
    figure, (axis,) = style.panels(1, height=3.0)
    axis.plot([p.steps / 1e6 for p in curve], [p.cost for p in curve], marker=".", label=algorithm.upper())
    if lqr is not None:
        axis.axhline(lqr, color=style.COLOURS[1], label="LQR")
        axis.axhline(2 * lqr, color=style.COLOURS[1], linestyle=":", label="twice LQR")
    axis.set_yscale("log")
    axis.set_xlabel("environment steps [million]")
    axis.set_ylabel("cost of the scene as it is [-]")
    axis.set_title(f"{scene.name}: {curve[-1].seconds:.0f} s of training")
    axis.legend()
    return figure


def table(found: Training, lqr: float | None) -> dict[str, Any]:
    """What `pliant train --json` prints."""
    return {
        "scene": found.policy.scene,
        "cost": found.cost,
        "lqr_cost": lqr,
        "steps": found.steps,
        "seconds": found.seconds,
        "steps_per_second": found.rate,
        "threads": found.threads,
        "curve": [dataclasses.asdict(point) for point in found.curve],
    }

"""Learning curves of apg, PPO and SAC against the processor time of one thread, in one picture.

`PYTHONPATH=benchmarks python -m cases.learning_curves` trains each on each scene, seed 0, writes
results/learning_curves.json and docs/figures/learning-curves.png; runs that are in the folder already are read.
--scale makes all runs shorter or longer.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy and torch are loaded

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from pliant.controllers import rl
from pliant.envs import Scene, scenes
from pliant.plants.files.atomic_files import write_text
from pliant.studies.commands import console
from pliant.studies.commands.train import lqr_cost
from pliant.studies.common import machine
from pliant.studies.figures import style

SCENES = ("single-link-slew", "two-link-reach")
GRADIENTS = {"single-link-slew": 300, "two-link-reach": 300}  # of apg, 16 lanes each
STEPS = {"ppo": 2_000_000, "sac": 200_000}
HERE = Path(__file__).parents[1]


def learned(scene: Scene, algorithm: str, scale: float, folder: Path) -> dict[str, Any]:
    """Steps, processor seconds and cost of every evaluation of one run, or what a former one left."""
    path = folder / f"{scene.name}-{algorithm}.json"
    whole = GRADIENTS[scene.name] * 16 * scene.steps if algorithm == "apg" else STEPS[algorithm]
    steps = max(1, int(scale * whole))
    if path.is_file() and json.loads(path.read_text("utf-8"))["asked"] == steps:
        return dict(json.loads(path.read_text("utf-8")))
    begin, told = time.process_time(), [(0.0, 0.0)]
    with console.bar(f"{algorithm} on {scene.name}") as tell:

        def progress(share: float, words: str) -> None:
            told.append((share * steps, time.process_time() - begin))
            tell(share, words)

        found = rl.train(scene, algorithm, seed=0, steps=steps, threads=1, progress=progress)
    at, seconds = np.array(told).T
    curve = [{"steps": p.steps, "seconds": float(np.interp(p.steps, at, seconds)), "cost": p.cost} for p in found.curve]
    run = {"scene": scene.name, "algorithm": algorithm, "asked": steps, "cost": found.cost, "curve": curve}
    run["seconds"] = seconds[-1]
    write_text(path, json.dumps(run, indent=1) + "\n")
    return run


@style.styled
def picture(runs: list[dict[str, Any]], lqr: dict[str, float | None]) -> Any:
    """The best cost so far of each run over the time that it took, a panel a scene."""
    figure, axes = style.panels(len(lqr), height=3.2)
    for axis, (name, least) in zip(axes, lqr.items()):
        for k, run in enumerate(r for r in runs if r["scene"] == name):
            seconds = [max(p["seconds"], 0.1) for p in run["curve"]]
            best = np.minimum.accumulate([p["cost"] for p in run["curve"]])
            axis.step(seconds, best, where="post", color=style.COLOURS[k], label=run["algorithm"])
        if least is not None:
            axis.axhline(least, color="0.4", linestyle=":", label="LQR")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel("processor time [s]")
        axis.set_ylabel("least cost so far [-]")
        axis.set_title(name)
    axes[0].legend()
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--folder", type=Path, default=Path("build/learning-curves"), help="of the runs")
    parser.add_argument("--out", type=Path, default=HERE / "results")
    parser.add_argument("--picture", type=Path, default=HERE.parent / "docs" / "figures" / "learning-curves.png")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    chosen = [scenes.get(name) for name in SCENES]
    runs = [learned(scene, name, given.scale, given.folder) for scene in chosen for name in ("apg", "ppo", "sac")]
    lqr = {scene.name: lqr_cost(scene) for scene in chosen}
    content = {"machine": machine.describe(), "scale": given.scale, "lqr": lqr, "runs": runs}
    write_text(given.out / "learning_curves.json", json.dumps(content, indent=1) + "\n")
    style.save(picture(runs, lqr), given.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())

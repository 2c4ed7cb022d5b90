"""What PPO reaches beside LQR, and how fast it gets there.

`PYTHONPATH=benchmarks python -m cases.ppo_beside_lqr` trains every seed on every scene and writes results/learning.json
and learning.md, steps a second (`cases.learning`) among them; runs that are in the folder already are read, not made
again.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy and torch are loaded

import argparse
import json
import sys
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from harness import sampling, table

from pliant.controllers import rl
from pliant.controllers.learning.policy import FOLDER, Policy
from pliant.envs import Scene, scenes
from pliant.plants.files.atomic_files import write_text
from pliant.plants.files.whole_folders import renewed
from pliant.studies.commands import console
from pliant.studies.commands.train import draw, lqr_cost
from pliant.studies.common import machine

from .learning import LANES, SCENE, rows

ASKED_RATE, ASKED_RATIO, ASKED_SECONDS = 40_000, 2.0, 600.0
SCENES, STEPS, SEEDS = ("single-link-slew", "two-link-reach"), 8_000_000, (0, 1, 2)
PACKAGES = ("pliant", "stable-baselines3", "torch", "numpy", "gymnasium")


def run(scene: Scene, seed: int, steps: int, folder: Path) -> dict[str, Any]:
    """One training, or what a former one left in `folder`."""
    words = f"pliant train {scene.name} --algorithm ppo --seed {seed} --steps {steps} --threads 1"
    path = folder / rl.CURVE
    have = rl.read_curve(path)[-1].steps if path.is_file() else -1
    if have < steps:
        with console.bar(f"train {scene.name}") as tell:
            options = {"seed": seed, "steps": steps, "threads": 1, "folder": folder, "resume": have >= 0}
            found = rl.train(scene, **options, command=words, progress=tell)
        draw(scene, "ppo", found, folder)
    policy, curve = Policy.load(folder / rl.POLICY), rl.read_curve(path)
    twice = 2 * (lqr_cost(scene) or np.inf)
    reached = next((p.seconds for p in curve if p.cost <= twice), None)
    return {
        "seed": seed,
        "cost": policy.made["cost"],
        "steps": curve[-1].steps,
        "seconds": curve[-1].seconds,
        "seconds_to_twice_lqr": reached,
        "folder": folder.name,
        "command": words,
    }


def results(scene: Scene, seeds: list[int], steps: int, folder: Path) -> dict[str, Any]:
    """All seeds on one scene, beside LQR."""
    made = [run(scene, seed, steps, folder / f"{scene.name}-{seed}") for seed in seeds]
    lqr, costs = lqr_cost(scene), [m["cost"] for m in made]
    assert lqr is not None
    return {
        "scene": scene.name,
        "lqr_cost": lqr,
        "median_cost": median(costs),
        "median_ratio": median(costs) / lqr,
        "range_of_ratio": [min(costs) / lqr, max(costs) / lqr],
        "longest_seconds": max(m["seconds"] for m in made),
        "runs": made,
    }


def ship(found: dict[str, Any], folder: Path) -> None:
    """Save the policy of the median seed among the package's own."""
    chosen = sorted(found["runs"], key=lambda m: m["cost"])[len(found["runs"]) // 2]
    Policy.load(folder / chosen["folder"] / rl.POLICY).save(FOLDER / found["scene"])
    found["shipped_seed"] = chosen["seed"]


def markdown(found: list[dict[str, Any]], rates: list[dict[str, Any]], about: dict[str, str]) -> str:
    """The table."""
    head = ["scene", "LQR's cost", "PPO's cost, median", "times LQR's: median (range)", "longest run", "to twice LQR's"]
    lines = []
    for f in found:
        low, high = f["range_of_ratio"]
        to_twice = [r["seconds_to_twice_lqr"] for r in f["runs"]]
        late = "not by every seed" if None in to_twice else f"{min(to_twice):.0f} to {max(to_twice):.0f} s"
        ratio = f"{f['median_ratio']:.2f} ({low:.2f} to {high:.2f})"
        costs = f"{f['lqr_cost']:.3f}", f"{f['median_cost']:.3f}"
        lines.append([f["scene"], *costs, ratio, f"{f['longest_seconds']:.0f} s", late])
    text = ["# Learning", "", "PPO by `pliant train`; costs are of the scene as it is, nothing drawn at random.", ""]
    text += table.grid(head, lines, 1)
    good = all(f["range_of_ratio"][1] <= ASKED_RATIO and f["longest_seconds"] <= ASKED_SECONDS for f in found)
    text += ["", f"Asked: at most {ASKED_RATIO:g} times LQR's cost in at most {ASKED_SECONDS:g} s, by every seed. "]
    text[-1] += "It holds." if good else "**It does not hold.**"
    text += ["", f"Steps a second with {LANES:,} lanes, {SCENE} (asked: at least {ASKED_RATE:,}):", ""]
    lines = [
        [r["name"], str(r["threads"]), table.number(median(r["samples"])), _range(r["samples"])]
        if r["samples"]
        else [r["name"], str(r["threads"]), r["failure"] or "-", ""]
        for r in rates
        if r["unit"] == sampling.RATE
    ]
    text += table.grid(["", "torch threads", "steps/s, median", "range"], lines, 1)
    others = [value for r in rates for value in r["others"]]
    if others:
        text += ["", f"Other processes used {np.mean(others):.2f} processors meanwhile, {max(others):.2f} at most."]
    text += ["", "On a busy machine several torch threads wait for each other: `pliant train` then takes one."]
    text += ["", "## Runs", ""]
    lines = [
        [
            r["command"],
            "yes" if r["seed"] == f["shipped_seed"] else "",
            f"{r['cost']:.3f}",
            f"{r['seconds']:.0f}",
            table.number(r["steps"] / r["seconds"]),
        ]
        for f in found
        for r in f["runs"]
    ]
    text += table.grid(["command", "shipped", "cost", "seconds", "steps/s, all included"], lines, 2)
    text += ["", "## Machine", "", *table.grid(["", ""], [[k, v] for k, v in about.items()], 2), ""]
    return "\n".join(text)


def _range(values: list[float]) -> str:
    return f"{table.number(min(values))} to {table.number(max(values))}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--steps", type=int, default=STEPS, help="of each run")
    parser.add_argument("--runs", type=Path, default=Path("build/learning"), help="folder of the runs")
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "results", help="folder of the tables")
    parser.add_argument("--ship", action="store_true", help="save the median seeds' policies into the package")
    given = parser.parse_args()
    found = [results(scenes.get(name), given.seeds, given.steps, given.runs) for name in SCENES]
    for f in found:
        f["shipped_seed"] = None
        if given.ship:
            ship(f, given.runs)
    rates = rows(quick=False)
    described = {k: v for k, v in machine.describe().items() if k in ("processor", "cores", "system", "python")}
    described |= {name: machine.version(name) for name in PACKAGES}
    content = {"about": described, "scenes": found, "rates": rates}
    text = markdown(found, rates, described)
    with renewed(given.out) as made:
        write_text(made / "learning.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
        write_text(made / "learning.md", text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())

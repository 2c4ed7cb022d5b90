"""Bounds of what motions miss over random boxes of parameters: a seeded campaign.

    python tests/campaigns/missed_over_boxes.py

Slews of one and two links, with and without feedback, over 1 to 3 of their parameters, 2 to 40 % each way. Wrong: one
of 10,000 random motions within the box misses by more than the bound, or leaves its tube. Told: how far the bound is
above the largest that was simulated.
"""

from __future__ import annotations

import time
import warnings
from typing import Any

import by_seed
import numpy as np

from pliant.controllers import TVLQR
from pliant.controllers.robust_analysis.miss_over_box import miss_over_box
from pliant.controllers.robust_analysis.worst_parameters import motions_in_box
from pliant.envs import scenes
from pliant.plants.core import parameters
from pliant.plants.core.errors import PliantError

TRIED = 10_000
TOGETHER = 2_000
SCENES = {
    "single-link-slew": (("payload.mass", "link.E", "hub_inertia"), ("tip_deflection", "hub_angle")),
    "two-link-reach": (("payload.mass", "link1.E", "link2.E"), ("tip_x", "tip_y")),
}


def run(seed: int, tried: int = TRIED) -> dict[str, Any]:
    began, rng = time.perf_counter(), np.random.default_rng(seed)
    name = list(SCENES)[seed % 2]
    scene, (paths, outputs) = scenes.get(name), SCENES[name]
    plant = scene.plant
    t = np.linspace(0.0, rng.uniform(0.2, 0.8), 31)
    u = np.array([np.atleast_1d(scene.nominal_input(s)) for s in t])
    nominal = plant.simulate(scene.initial[0], u, t)
    chosen = rng.permutation(paths)[: rng.integers(1, 4)]
    box = {}
    for path in chosen:
        value, width = parameters.get(plant, path), rng.uniform(0.02, 0.4)
        box[str(path)] = (value * (1 - width), value * (1 + width))
    gains = None
    if rng.random() < 0.5:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # any gains will do
            K = TVLQR.design(
                plant.linearize_along(nominal), 100 * np.eye(plant.nx), 0.01 * np.eye(plant.nu)
            ).regulator.K
        gains = np.concatenate([K, K[-1:]])
    row: dict[str, Any] = {"seed": seed, "scene": name, "box": box, "feedback": gains is not None}
    try:
        found = miss_over_box(plant, nominal, box, outputs, gains=gains)
    except PliantError as refused:
        return {**row, "refused": str(refused), "gap": None, "wrong": False}
    motions = motions_in_box("campaign", plant, nominal, box, outputs, gains, 10)
    wrong, share = False, 0.0
    for _ in range(0, tried, TOGETHER):
        sides = rng.uniform(-1, 1, (min(tried, TOGETHER), len(box)))
        sides[::2] /= np.abs(sides[::2]).max(axis=1, keepdims=True)
        missed = motions.missed(sides)
        for j, output in enumerate(outputs):
            of, tube = missed[..., j], found[output].tube
            share = max(share, float(np.abs(of).max() / found[output].upper))
            wrong |= bool((of < tube[:, 0]).any() or (of > tube[:, 1]).any())
    gap = max(f.upper / f.lower - 1 for f in found.values())
    seconds = round(time.perf_counter() - began, 2)
    return {**row, "gap": gap, "share": share, "wrong": wrong or share > 1, "seconds": seconds}


def summary(rows: list[dict[str, Any]]) -> str:
    told = [r for r in rows if r["gap"] is not None]
    gaps, shares = np.array([r["gap"] for r in told]), np.array([r["share"] for r in told])
    return (
        f"{len(rows)} boxes, {len(rows) - len(told)} refused: {sum(r['wrong'] for r in rows)} wrong; bound over the "
        f"largest found within {np.median(gaps):.1%} in half, {gaps.max():.1%} at most; random motions reach "
        f"{shares.max():.1%} of it"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 40, run, summary, lambda row: row["wrong"])

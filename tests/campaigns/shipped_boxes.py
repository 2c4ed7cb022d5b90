"""Bounds over boxes of parameters of the shipped scenes' own loops: LQR and LQG about their goals, by number.

    python tests/campaigns/shipped_boxes.py

The box: the ranges that a scene draws its parameters from. Wrong: a loop of 10,000 tried (random points and edges of
what was shown to be stable) grows. Printed: a table of what is shown, what is unstable, and how far both are apart.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import numpy as np

from pliant.controllers import LQG, LQR
from pliant.controllers.robust_analysis.loop_over_box import loop_over_box
from pliant.controllers.robust_analysis.nearest_instability import growth
from pliant.controllers.robust_analysis.robust_stability import require_box, robust_stability
from pliant.envs import scenes
from pliant.plants.core import parameters
from pliant.plants.core.errors import PliantError

TRIED = 10_000
MOST_STATES = 16
LAWS = {"LQR": LQR, "LQG": LQG}
CASES = [(name, law) for name in scenes.names() for law in LAWS]


def run(seed: int, tried: int = TRIED) -> dict[str, Any]:
    """Of one scene and law: the row of the table."""
    began, (name, law) = time.process_time(), CASES[seed]
    scene = scenes.get(name)
    row: dict[str, Any] = {"seed": seed, "scene": name, "law": law, "wrong": False}
    if scene.plant.nx > MOST_STATES or scene.goal_rates:
        return {**row, "why": "more states, or a goal that moves"}
    box = {}
    for path, low, high in scene.randomise:
        value = parameters.get(scene.plant, path)
        box[path] = tuple(sorted((low * value, high * value)))
    try:
        designed = LAWS[law].for_scene(scene)
        found = robust_stability(scene.plant, designed, box, dict(scene.goal))
        names, middle, half = require_box("box", box)
        loop = loop_over_box(scene.plant, designed, names, middle, half, dict(scene.goal))
    except (PliantError, ValueError) as why:
        return {**row, "why": str(why)[:100]}
    seconds = round(time.process_time() - began, 1)
    points = np.random.default_rng(0).uniform(-1, 1, (tried, len(names)))
    points[::2] /= np.abs(points[::2]).max(axis=1, keepdims=True)
    grows = max(growth(loop.state_matrix(found.stable_to * delta), loop.dt) for delta in points)
    row |= {"states": len(loop.state_matrix(np.zeros(len(names)))), "parameters": len(names)}
    row |= {"stable_to": found.stable_to, "unstable_at": found.unstable_at, "most": found.most, "parts": found.parts}
    edge = found.most if found.unstable_at is None else found.unstable_at
    row |= {"gap": edge / max(found.stable_to, 1e-9) - 1, "left": found.left, "seconds": seconds}
    return {**row, "wrong": bool(found.stable_to > 0 and grows > 0)}


def summary(rows: list[dict[str, Any]]) -> str:
    told = ["| scene | law | states | parameters | shown, boxes | unstable at | apart | parts | s |", "|" + "---|" * 9]
    for r in rows:
        if "gap" in r:
            at = f"none in {r['most']:.3g}" if r["unstable_at"] is None else f"{r['unstable_at']:.4g}"
            told.append(
                f"| {r['scene']} | {r['law']} | {r['states']} | {r['parameters']} | {r['stable_to']:.4g} | {at} | "
                f"{r['gap']:.1%} | {r['parts']} | {r['seconds']} |"
            )
        else:
            told.append(f"| {r['scene']} | {r['law']} | {r['why']} |")
    gaps = [r["gap"] for r in rows if "gap" in r]
    within = sum(gap < 0.0205 for gap in gaps)
    told.append(f"{len(gaps)} loops, {within} within 2 %, {sum(r['wrong'] for r in rows)} wrong")
    return "\n".join(told)


if __name__ == "__main__":
    by_seed.main(__doc__, len(CASES), run, summary, lambda row: row["wrong"])

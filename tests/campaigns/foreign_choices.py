"""`choose` on machines unlike those of `pliant study effectivity`; see foreign_machines.

    python tests/campaigns/foreign_choices.py --count 36

By seed, in turn: a link of 5 cm to 40 m with a payload of up to ten times its mass, turned under gravity of either
sign; a link with a hub radius spun up and down again; two links, one far softer; a beam let go under gravity of either
sign, clamped or hinged; a small hub with long booms, free to move; a crank with a rod of aluminium. Damping is none or
up to a fifth of the critical. True is what a model on no ladder does: exact rotations with stretch and shear of more
shapes, of other bodies more modes than physics has, played by CVODES. Exit status 1 where "met" is wrong, `choose`
crashes, or refuses though a rung keeps half the tolerance.
"""

from __future__ import annotations

import dataclasses
import time
import warnings
from typing import Any

import by_seed
import numpy as np
from foreign_machines import KINDS, scene_of

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.choice import choose

PLAYED = 1e-9
EXACT = {"kinematics": "strain", "basis": "polynomial", "theory": "timoshenko", "extensible": True}


def finer(scene: Scene) -> Plant:
    """A model of the scene's machine that is on no ladder and no physics of `choose`."""
    plant: Any = scene.plant
    kind = type(plant).__name__
    if kind == "SingleLinkArm":
        changes: dict[str, Any] = {**EXACT, "modes": 7, "frame": "clamped"}
    elif kind == "TwoLinkArm":
        changes = {**EXACT, "modes": (6, 6), "reduction": "full", "tip_slope": True}
    elif kind == "LargeDeflectionBeam":
        changes = {**EXACT, "segments": 1, "modes": 10, "points": None, "stretches": 4, "shears": 4}
    elif kind == "SliderCrank":
        changes = {"kinematics": "stiffened", "basis": "pinned-pinned", "modes": 9, "axial_modes": 0}
    else:
        bodies = tuple(dataclasses.replace(a, modes=(6, 6)) for a in plant.appendages)
        changes = {"kinematics": "stiffened", "appendages": bodies}
    found: Plant = dataclasses.replace(plant, **changes)
    return found


def run(seed: int) -> dict[str, Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = scene_of(seed)
        row: dict[str, Any] = {"seed": seed, "kind": KINDS[seed % len(KINDS)].__name__, "tolerance": scene.tolerance}
        row |= {"plant": scene.plant.label, "crashed": "", "wrong": False, "refused": False}
        began = time.process_time()
        try:
            found = choose(scene)
        except Exception as failure:  # whatever it is: the campaign counts crashes
            return row | {"crashed": f"{type(failure).__name__}: {failure}"[:300]}
        row |= {"cpu": round(time.process_time() - began, 2), "met": found.met, "chosen": found.plant.label}
        row |= {"physics": found.physics, "missing": list(found.missing), "beyond": list(found.beyond)}
        row["said"] = [(r.variant, r.error, r.bound, r.outside) for r in found.rungs if r.error is not None]
        motions = Motions(scene)
        try:
            true = motions.compared(motions.run(finer(scene), method="cvodes", rtol=PLAYED, atol=PLAYED / 100))
        except PliantError as failure:
            return row | {"why": f"{type(failure).__name__}: {failure}"[:200]}
        by_label = {p.label: p for p in (*scene.plant.ladder(), scene.plant, *map(scene.plant.physics, range(8)))}
        errors = {}
        for variant, *_ in row["said"]:
            try:
                errors[variant] = float(np.abs(motions.outputs(by_label[variant], PLAYED) - true).max())
            except PliantError:
                errors[variant] = float("inf")
    tolerance = scene.tolerance
    row |= {"true": list(errors.values()), "error": errors.get(found.plant.label)}
    row["wrong"] = bool(found.met and row["error"] > tolerance)
    row["refused"] = bool(not found.met and not found.beyond and min(errors.values()) <= tolerance / 2)
    return row


def summary(rows: list[dict[str, Any]]) -> str:
    known = [r for r in rows if "true" in r]
    ratios = sorted(p / t for r in known for (_, p, *_), t in zip(r["said"], r["true"]) if 0.0 < t < float("inf"))
    inside = sum(0.5 <= one <= 2.0 for one in ratios)
    return (
        f"{len(rows)} machines, {len(known)} with a truth: {sum(r['met'] for r in known)} met, "
        f"{sum(r['wrong'] for r in known)} wrong, {sum(r['refused'] for r in known)} refused though a rung keeps half "
        f"the tolerance, {sum(bool(r['crashed']) for r in rows)} crashed; of {len(ratios)} told errors {inside} within "
        "0.5 to 2 of the true ones"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 40, run, summary, lambda row: row["wrong"] or row["refused"] or bool(row["crashed"]))

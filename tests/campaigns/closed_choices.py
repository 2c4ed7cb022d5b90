"""`choose` in closed loop on arms that stand on their heads: a seeded campaign.

    python tests/campaigns/closed_choices.py --count 20

A link of 0.3 to 3 m stands up within half a radian and is turned by up to a radian, or nudged by a twentieth of that;
without its law, PD or every fourth time LQG on what sensors read, it falls. True is what the same law does on a model
that is on no ladder: exact rotations, stretch and shear, seven shapes, played by CVODES. Counted are "met" where the
chosen plant's own closed loop is farther from it than the tolerance (wrong), refusals where a rung keeps half of it,
and whatever `choose` raises.
"""

from __future__ import annotations

import dataclasses
import time
import warnings
from typing import Any

import by_seed
import numpy as np

from pliant.controllers import LQG, PD
from pliant.envs import scenes
from pliant.envs.scenes.scene import Scene
from pliant.plants import Payload, PliantError, beams
from pliant.studies.common.reference_motions import ClosedMotions
from pliant.studies.fidelity.choice import choose

PLAYED = 1e-8  # rtol
NUDGE = 0.05
TRUE: dict[str, Any] = {"kinematics": "strain", "basis": "polynomial", "theory": "timoshenko", "extensible": True}


def machine(seed: int) -> Scene:
    """Length, section, payload, way and tolerance by chance."""
    rng = np.random.default_rng([7, seed])
    own, L = scenes.get("single-link-slew"), float(10 ** rng.uniform(-0.5, 0.5))
    depth = L * 10 ** rng.uniform(-2.1, -1.6)
    link = beams.Beam.rectangular(L, width=3 * depth, depth=depth, material=beams.ALUMINIUM)
    link = dataclasses.replace(link, damping=float(10 ** rng.uniform(-4.5, -3.0)))
    load = Payload(mass=link.mass * rng.uniform(0.1, 1.5))
    plant = dataclasses.replace(
        own.plant, link=link, payload=load, gravity=9.81, hub_friction=0.0, hub_inertia=link.mass * L**2 * 0.1
    )
    begin, way = np.pi / 2 + rng.uniform(-0.5, 0.5), rng.choice([-1, 1]) * rng.uniform(0.2, 1.0)
    way *= NUDGE ** (seed % 4 == 3)  # an LQG goes to its goal at once
    move = float(np.sqrt(L) * rng.uniform(0.8, 2.0))
    steps = int(rng.integers(150, 300))
    return dataclasses.replace(
        own,
        plant=plant,
        start=(("hub_angle", begin),),
        goal=(("hub_angle", begin + way),),
        move_time=move,
        duration=3 * move,
        dt=3 * move / steps,
        tolerance=float(L * 10 ** rng.uniform(-4.0, -2.5)),
        limits=(1e6,),
    )


def run(seed: int) -> dict[str, Any]:
    scene, kind = machine(seed), (PD, PD, PD, LQG)[seed % 4]
    row: dict[str, Any] = {"seed": seed, "law": kind.__name__, "tolerance": scene.tolerance, "crashed": ""}
    row |= {"wrong": False, "refused": False}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            law: Any = kind.for_scene(scene)
        except PliantError as failure:
            return row | {"no_law": str(failure)[:200]}
        began = time.process_time()
        try:
            found = choose(scene, motions=[law])
        except Exception as failure:  # whatever it is: the campaign counts crashes
            return row | {"crashed": f"{type(failure).__name__}: {failure}"[:300]}
        row |= {"cpu": round(time.process_time() - began, 2), "met": found.met, "chosen": found.plant.label}
        row |= {"physics": found.physics, "missing": list(found.missing)}
        motions = ClosedMotions(scene, law, "law")
        finer: Any = dataclasses.replace(scene.plant, **TRUE, modes=7)
        true, errors = motions.outputs(finer, PLAYED, method="cvodes"), {}
        plants = {p.label: p for p in (*motions.ladder, scene.plant)}
        for rung in found.rungs:
            if rung.error is not None and rung.variant in plants:
                try:
                    errors[rung.variant] = float(np.abs(motions.outputs(plants[rung.variant], PLAYED) - true).max())
                except PliantError:
                    errors[rung.variant] = float("inf")
        try:
            own = np.abs(motions.outputs(found.plant, PLAYED) - true).max()
        except PliantError:
            own = np.inf
    row |= {"told": {r.variant: r.error for r in found.rungs if r.variant in errors}, "true": errors}
    row |= {"error": float(own), "wrong": bool(found.met and own > scene.tolerance)}
    return row | {"refused": bool(not found.met and min(errors.values()) <= scene.tolerance / 2)}


def summary(rows: list[dict[str, Any]]) -> str:
    played = [r for r in rows if "true" in r]
    pairs = [(r["told"][k], r["true"][k]) for r in played for k in r["true"]]
    ratios = sorted(told / true for told, true in pairs if 0 < true < np.inf and 0 < told < np.inf)
    told = f"; told over true error {ratios[0]:.2f} to {ratios[-1]:.2f}" if ratios else ""
    return (
        f"{len(rows)} arms, {len(played)} with a law: {sum(r['met'] for r in played)} met, "
        f"{sum(r['wrong'] for r in rows)} wrong, {sum(r['refused'] for r in rows)} refused though a rung keeps half "
        f"the tolerance, {sum(bool(r['crashed']) for r in rows)} crashed{told}"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 20, run, summary, lambda row: row["wrong"] or row["refused"] or bool(row["crashed"]))

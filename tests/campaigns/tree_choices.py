"""What `choose` claims on planar trees whose true motion another model tells: a seeded campaign.

    python tests/campaigns/tree_choices.py

A tree of one link is the same machine as `SingleLinkArm`, one of two links as `TwoLinkArm`: both with exact rotations,
five polynomials a link, shear and rotary inertia (Timoshenko), equations of another file than the trees'. Each is
turned from rest to rest by the torques of the rigid tree, so fast that its links bend by up to 5 cm of their 0.7 m.
Counted are: "met" where the chosen plant is farther from the arm than the tolerance (wrong), errors above their bound
(above), refusals, and whatever `choose` raises (crashed).
"""

from __future__ import annotations

import dataclasses
import time
import warnings
from typing import Any

import by_seed
import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleTree, Joint, Plant, SingleLinkArm, TreeBody, TwoLinkArm, beams
from pliant.plants.beams.payload import Payload
from pliant.studies import choose
from pliant.studies.common.reference_motions import Motions

LENGTH, MOST = 0.7, 0.05  # [m] of a link, of what it bends
PLAYED = 1e-8  # rtol
ARM: dict[str, Any] = {"kinematics": "strain", "theory": "timoshenko", "basis": "polynomial"}


def machine(seed: int) -> Scene:
    """One link where the seed is even, two where it is odd; strip, payload, angles, bend and tolerance by chance."""
    rng = np.random.default_rng(seed)
    links = 1 + seed % 2
    sides = {"width": rng.uniform(0.03, 0.05), "depth": float(np.exp(rng.uniform(np.log(0.005), np.log(0.009))))}
    strip = beams.Beam.rectangular(LENGTH, **sides, material=beams.ALUMINIUM)
    strip = dataclasses.replace(strip, damping=float(10 ** rng.uniform(-4.5, -3.0)))
    load = Payload(mass=rng.uniform(0.1, 0.5), inertia=10 ** rng.uniform(-4.0, -3.0))
    bodies = [TreeBody(name=f"b{k}", joint=Joint(name=f"j{k}"), beam=strip, modes=(2, 0, 0, 0)) for k in range(links)]
    tree = FlexibleTree.serial(bodies, payload=load, gravity=(0.0, 0.0, 0.0))
    start, way = rng.uniform(-0.5, 0.5, links), rng.choice([-1, 1], links) * rng.uniform(0.3, 0.9, links)
    bend, tolerance = rng.uniform(0.005, 0.04), 10 ** rng.uniform(-3.3, -2.3)

    def lasting(seconds: float) -> Scene:
        at = [tuple((f"j{k}", float(a)) for k, a in enumerate(angles)) for angles in (start, start + way)]
        steps = max(60, int(np.ceil(1.3 * seconds / 0.01)))
        return Scene(
            name="tree", about="joints turn", plant=tree, start=at[0], goal=at[1], move_time=seconds,
            duration=1.3 * seconds, dt=1.3 * seconds / steps, compare=("tip_x", "tip_y"), tolerance=tolerance,
            limits=(1e3,) * links,
        )  # fmt: skip

    seconds = 1.0
    for _ in range(4):  # what bends goes as one over the time squared, where nothing swings
        seconds *= np.sqrt(bent(lasting(seconds)) / bend)
    while bent(lasting(seconds)) > MOST:
        seconds *= 1.2
    return lasting(seconds)


def bent(scene: Scene) -> float:
    """Largest deflection [m] of a link on the scene's own plant."""
    motion = scene.open_loop(rtol=1e-5, atol=1e-8)
    return max(float(np.abs(motion[name]).max()) for name in scene.plant.deflections)


def known(scene: Scene) -> tuple[Plant, np.ndarray]:
    """The arm that is this tree, and its start."""
    tree: Any = scene.plant
    angles, (first, *further) = [value for _, value in scene.start], [b.beam for b in tree.bodies]
    arm: Any
    if further:
        arm = TwoLinkArm(link1=first, link2=further[0], payload=tree.payload, gravity=0.0, modes=(5, 5), **ARM)
    else:
        arm = SingleLinkArm(link=first, hub_inertia=0.0, payload=tree.payload, modes=5, **ARM)
    return arm, np.array([*angles, *np.zeros(arm.nx - len(angles))])


def run(seed: int) -> dict[str, Any]:
    began = time.process_time()
    scene = machine(seed)
    links = len(scene.start)
    row: dict[str, Any] = {"seed": seed, "links": links, "tolerance": scene.tolerance, "bent": bent(scene)}
    row["move_time"] = scene.move_time
    row |= {"wrong": False, "above": False, "crashed": ""}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = choose(scene)
        except Exception as failure:  # whatever it is: the campaign counts crashes
            return row | {"crashed": f"{type(failure).__name__}: {failure}"[:300]}
        motions, (arm, x0) = Motions(scene), known(scene)
        true = arm.simulate(x0, motions.held, scene.times, rtol=PLAYED, atol=1e-10)
        own = motions.outputs(found.plant, PLAYED)
    error = float(np.abs(own - np.column_stack([true["tip_x"], true["tip_y"]])).max())
    chosen = next(r for r in found.rungs if r.chosen)
    row |= {"chosen": found.plant.label, "met": found.met, "error": error, "told": chosen.error, "bound": chosen.bound}
    row |= {"wrong": found.met and error > scene.tolerance, "above": found.met and error > chosen.bound}
    row |= {"missing": list(found.missing), "physics": found.physics} if not found.met else {}
    return row | {"seconds": round(time.process_time() - began, 1)}


def summary(rows: list[dict[str, Any]]) -> str:
    crashed = sum(bool(r["crashed"]) for r in rows)
    played = [r for r in rows if not r["crashed"]]
    met = [r for r in played if r["met"]]
    ratios = sorted(r["told"] / r["error"] for r in met)
    told = f"; told over true error {ratios[0]:.2f} to {ratios[-1]:.2f}" if ratios else ""
    return (
        f"{len(rows)} trees, links bend by up to {1e3 * max(r['bent'] for r in rows):.0f} mm: {len(met)} met, of them "
        f"{sum(r['wrong'] for r in rows)} wrong and {sum(r['above'] for r in rows)} above their bound; "
        f"{len(played) - len(met)} refused, {crashed} crashed{told}"
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 12, run, summary, lambda row: row["wrong"] or row["above"] or bool(row["crashed"]))

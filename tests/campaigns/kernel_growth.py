"""Kernels are native for every size, compiled in good time, at a cost that grows at most as the cube of the states.

    python tests/campaigns/kernel_growth.py --count 60

A seed is a chain of sizes of one plant by chance: an arm of one or two links of 1 to 8 modes a link, stiffened or with
exact rotations, its bending stiffness over two decades, payload and joint mass by chance; or a strain beam of 3 to 14
coordinates, free of load or loaded. Its sizes are compiled (the usual check against extended precision decides) and
counted: what falls back to the virtual machine, takes longer to compile than 10 s of a processor, or has operations
that grow faster than the cube of the states, is a fault.
"""

from __future__ import annotations

import dataclasses
import resource
import warnings
from typing import Any

import by_seed
import casadi as ca
import numpy as np

from pliant.plants import LargeDeflectionBeam, Payload, Plant, SingleLinkArm, TwoLinkArm
from pliant.plants.integration.batch_stepper import rate_function, step_kernel
from pliant.plants.native import compiler, kernel_loader

MODES, COORDINATES = (1, 2, 4, 6, 8), (3, 6, 10, 14)
SLOW = 10.0  # [s] of a processor, to compile
SILENT = (ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_ASSIGN)


def operations(plant: Plant) -> int:
    """Of a right-hand side."""
    rate = rate_function(plant)
    return sum(rate.instruction_id(k) not in SILENT for k in range(rate.n_instructions()))


def chain(seed: int) -> list[Plant]:
    """Sizes of one plant, ascending."""
    rng = np.random.default_rng(seed)
    family = ("one", "two", "beam")[seed % 3]
    load = Payload(mass=float(10 ** rng.uniform(-2, 1)), inertia=float(10 ** rng.uniform(-4, -2)))
    if family == "beam":
        beam = LargeDeflectionBeam.textbook()
        beam = dataclasses.replace(beam, payload=load if rng.random() < 0.5 else beam.payload, kinematics="strain")
        return [dataclasses.replace(beam, modes=n) for n in COORDINATES]
    kinematics, basis = rng.choice(["stiffened", "strain"]), rng.choice(["payload", "polynomial", "clamped-free"])
    given: dict[str, Any] = {"kinematics": str(kinematics), "basis": str(basis), "payload": load}
    if family == "one":
        arm = SingleLinkArm.textbook()
        stiff = dataclasses.replace(arm.link, E=arm.link.E * float(10 ** rng.uniform(-1, 1)))
        return [dataclasses.replace(arm, link=stiff, modes=n, **given) for n in MODES]
    two = TwoLinkArm.textbook()
    stiff = dataclasses.replace(two.link1, E=two.link1.E * float(10 ** rng.uniform(-1, 1)))
    given |= {"link1": stiff, "link2": stiff, "joint_mass": float(10 ** rng.uniform(-1, 1))}
    return [dataclasses.replace(two, modes=(n, n), **given) for n in MODES]


def compiled(plant: Plant) -> tuple[bool, float, str]:
    """Whether its kernel is native, seconds that the compiler worked (0 from the cache), and why not."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", kernel_loader.NativeWarning)
        native = step_kernel(plant, "rk4", np.dtype(float)).native
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    worked = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return native, worked, "; ".join(str(w.message) for w in said)


def run(seed: int, longest: int = 1_000_000) -> dict[str, Any]:
    """longest: sizes of more operations are counted alone, not compiled."""
    plants = chain(seed)
    counts = [operations(plant) for plant in plants]
    found = [compiled(plant) for plant, count in zip(plants, counts) if count <= longest]
    states = [plant.nx for plant in plants]
    pairs = [(i, j) for j in range(len(plants)) for i in range(j)]
    power = max(float(np.log(counts[j] / counts[i]) / np.log(states[j] / states[i])) for i, j in pairs)
    return {
        "seed": seed,
        "plant": f"{type(plants[0]).__name__} ({plants[0].label})",
        "fell_back": [why for native, _, why in found if not native],
        "seconds": round(max(worked for _, worked, _ in found), 2),
        "operations": counts,
        "power": round(power, 3),
    }


def faulty(row: dict[str, Any]) -> bool:
    return bool(row["fell_back"]) or row["seconds"] > SLOW or row["power"] > 3.0


def summary(rows: list[dict[str, Any]]) -> str:
    slowest, steepest = max(r["seconds"] for r in rows), max(r["power"] for r in rows)
    longest = max(max(r["operations"]) for r in rows)
    return (
        f"{len(rows)} chains of sizes, {sum(bool(r['fell_back']) for r in rows)} with a fall-back; at most {longest:,} "
        f"operations, {slowest:.1f} s of a processor to compile, growth as states^{steepest:.2f}; "
        f"{sum(map(faulty, rows))} faulty"
    )


if __name__ == "__main__":
    assert kernel_loader.wanted(), "PLIANT_NATIVE=0: nothing is compiled"
    compiler.toolchain()
    by_seed.main(__doc__, 60, run, summary, faulty)

"""Measure Pliant beside its peers in one run and write the table: `make bench`.

Data on stdout and in benchmarks/results, progress on stderr. --quick: few, short samples; --only: one part. Both write
to build/benchmarks, so that the committed results stay those of a whole run.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"  # before NumPy, torch and MuJoCo are loaded
os.environ.setdefault("MUJOCO_GL", "disable")
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")  # JAX on one thread

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import mean

from cases import (
    cold_start,
    controller_acts,
    environments,
    fma_peak,
    kernel_growth,
    learning,
    motions,
    physics,
    spacecraft,
    stability,
    tree_growth,
    trees,
)
from cases import soak as soaking
from harness import sampling, table, targets
from peers import cantilever, peers

from pliant.plants.native import compiler, kernel_loader
from pliant.studies.commands import console
from pliant.studies.common import machine

HERE = Path(__file__).parent
PARTS: dict[str, Callable[[], Sequence[sampling.Case]]] = {
    "machine": lambda: list(fma_peak.cases()),
    "physics": lambda: [*physics.cases(), *peers.physics_cases()],
    "jacobians": lambda: list(physics.jacobian_cases()),
    "growth": lambda: list(kernel_growth.cases()),
    "environments": lambda: [*environments.cases(), *peers.environment_cases()],
    "motions": lambda: list(motions.cases()),
    "cantilever": lambda: list(cantilever.cases()),
    "stability": lambda: list(stability.cases()),
    "spacecraft": lambda: list(spacecraft.cases()),
    "controllers": lambda: list(controller_acts.cases()),
    "trees": lambda: list(trees.cases()),
    "tree growth": lambda: list(tree_growth.cases()),
}
PACKAGES = (
    "pliant",
    "numpy",
    "casadi",
    "gymnasium",
    "mujoco",
    "exudyn",
    "soromox",
    "jax",
    "stable-baselines3",
    "torch",
    "daqp",
    "do-mpc",
)


def about(rows: Sequence[sampling.Row]) -> dict[str, str]:
    """The machine and the versions; no names of hosts, users or folders."""
    try:
        tools = compiler.toolchain()
        made = f"{tools.version}, {tools.width}-bit vectors"
        made += (
            "" if kernel_loader.wanted() else "; not used, PLIANT_NATIVE=0: every row of Pliant is the virtual machine"
        )
    except compiler.CompileError:
        made = "none: the virtual machine runs"
    others = [value for row in rows for value in row.others]
    busy = f"{mean(others):.2f} of them on average" if others else "not known"
    keys = ("processor", "cores", "system", "python")
    described = {k: v for k, v in machine.describe().items() if k in keys}
    described |= {"processors used by others meanwhile": busy, "compiler": made}
    return described | {name: machine.version(name) for name in PACKAGES}


def notes(part: str | None, rows: Sequence[sampling.Row], soak: soaking.Soak | None) -> list[str]:
    """What must be known to read the table."""
    said = []
    others = [value for row in rows for value in row.others]
    if others and mean(others) > sampling.DISTURBED:
        said.append(
            f"**Disturbed run**: other processes used {mean(others):.2f} processors on average. Ratios hold roughly, "
            "rates and times are worse than the machine's own; repeat it on an idle machine."
        )
    if sampling.BUSY in os.environ:
        said.append(
            "Times are of the processor, over the threads of a row, not of the wall: others kept the machine busy, "
            "which still slows what shares a core's units and caches with them."
        )
    if part in (None, "physics", "environments"):
        said.append(
            "The peers' settings are the fastest found: MuJoCo (RK4 where no integrator is named) without contacts and "
            "constraints, Exudyn's fast module "
            "with explicit steps, dense algebra and the mass matrix inverted per body."
        )
    if part in (None, "environments"):
        scene = environments.scenes.get(environments.SCENE)
        said.append(
            f"Environments: {environments.SCENE} ({scene.plant.nx} states, {scene.plant.label}) with {scene.substeps} "
            "RK4 substeps a step unless said otherwise, randomised start and payload, autoreset; random actions drawn "
            "beforehand. CartPole and Pendulum are far smaller systems (4 and 2 states, one Euler step)."
        )
        tolerance = 1e3 * scene.tolerance
        few = environments.fewest_substeps()
        spoilt, ended = environments.diverged(few)
        errors = ", ".join(
            f"{n}: {'unstable' if e is None else f'{1e3 * e:.2g} mm'}" for n, e in environments.substep_errors()
        )
        said.append(
            f"The fewest substeps that keep {environments.SCENE}'s tolerance of {tolerance:.3g} mm: "
            f"{few}. Error of its open-loop motion by substeps: {errors}. Episodes that diverged under random "
            f"actions: {spoilt} of {ended:,}."
        )
        times = sampling.ratio(
            targets.find(rows, environments.GROUP, physics.DOUBLE, 1024, 2),
            targets.find(rows, environments.GROUP, peers.SWIMMER),
        )
        if times is not None:
            said.append(f"SIMD double with 1,024 environments on 2 threads makes {times:.0f} times Swimmer-v5's steps.")
    if part in (None, "physics"):
        said.append(
            "Physics: TwoLinkArm.textbook(), 12 states, gravity on; RK4 steps of 2 ms, the input held, many in one "
            "call. The peers' chain has 12 states too. implicitfast is MuJoCo's method of first order: fewer "
            "operations a step, and an error a step that falls with the step, where RK4's falls with its fourth power. "
            "mujoco.batch keeps arrays of all simulations live between calls, mujoco.rollout returns each step's "
            "state. SoRoMoX's row is another machine of the same size: cantilever-drop's clamped beam as six constant "
            "curvatures, RK4 through jax.jit and jax.vmap, compiling not timed."
        )
        apart = peers.difference()
        if apart is not None:
            said.append(f"MuJoCo's and Exudyn's chains agree to {apart:.1g} rad after 0.5 s: they are the same chain.")
    if soak is not None:
        said.append(
            f"Soak: {soak.steps:,} environment steps with random actions in {soak.seconds:.0f} s, {soak.episodes:,} "
            f"episodes, {soak.diverged:,} diverged; {soak.memory[-1]:.0f} MB resident at the end."
        )
    return said + cantilever.notes(rows) + controller_acts.notes(rows) + trees.notes(rows) + tree_growth.notes(rows)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="3 rounds of short samples, a soak of 2 million steps")
    parser.add_argument("--only", choices=[*list(PARTS)[1:], "start", "soak", "learning"], help="one part")
    parser.add_argument("--rounds", type=int, help="samples of each row (default 9)")
    parser.add_argument(
        "--against", metavar="PYTHON", help="interpreter of another checkout: its start, in turn with ours"
    )
    parser.add_argument("--processor-time", action="store_true", help="for a machine that others keep busy: see notes")
    parser.add_argument("--out", type=Path, help="folder for the results")
    given = parser.parse_args()
    rounds = given.rounds or (3 if given.quick else 9)
    if given.processor_time:
        sampling.by_processor_time()
    if rounds < 1:
        parser.error(f"--rounds {rounds} must be at least 1")
    whole = not (given.quick or given.only)
    folder = given.out or (HERE / "results" if whole else HERE.parent / "build" / "benchmarks")

    def wanted(name: str) -> bool:
        return given.only in (None, name)

    rows: list[sampling.Row] = []
    soak, steps = None, soaking.QUICK if given.quick else soaking.STEPS
    if wanted("soak"):
        with console.bar("soak") as progress:
            soak = soaking.run(steps, progress)
    cases = [case for name, part in PARTS.items() if wanted(name) or name == "machine" for case in part()]
    if cases:
        with console.bar("measure") as progress:
            rows += sampling.measure(cases, rounds, 0.05 if given.quick else 0.2, progress)
    if wanted("start"):
        with console.bar("start") as progress:
            rows += cold_start.measure(min(rounds, 5), progress)
            if given.against:
                rows += cold_start.against(rounds, given.against, progress)

    def report() -> str:
        checks = targets.checks(rows, soak, steps)
        if not whole:
            checks = [c for c in checks if c.measured is not None]
        said, described = notes(given.only, rows, soak), about(rows)
        own, pictures = {}, {}
        if grown := [row for row in rows if row.group == kernel_growth.GROUP]:
            peak = next((row for row in rows if row.name == fma_peak.PEAK), None)
            own[kernel_growth.GROUP] = kernel_growth.lines(grown, peak)
            pictures["growth"] = kernel_growth.chart(grown)
        extra = {"soak": asdict(soak) if soak else None}
        table.write(folder, rows, checks, described, said, extra, own, pictures)
        return table.markdown(rows, checks, described, said, own)

    if wanted("learning"):
        report()  # the longest part comes last: what is measured is kept if it is broken off
        rows += [sampling.Row(**row) for row in learning.rows(given.quick)]
    print(report())
    return 0 if soak is None or soak.passed else 1


if __name__ == "__main__":
    sys.exit(main())

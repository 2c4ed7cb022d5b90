"""3 s of the scene cantilever-drop to a given accuracy: Pliant's native kernel of one lane beside Exudyn's best.

The error is the tip's largest distance from the truth, at 601 times from 0 to 3 s; between its steps each program is
read by the cubic through the tip's positions and velocities. The beam theories differ by up to 2e-4 m, so each program
is held against the truth of its own: Pliant (inextensible) against 14 coordinates, Exudyn (extensible, shearable)
against its own 40 elements at 24,000 steps. Both truths are checked against tests/reference/large_beam.json.
What is timed is the solver alone, without output; building and assembling the model is left out.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from harness.sampling import TIME, Case, Row, Sampler, ratio, time_of
from harness.tip_error import COARSE, END, FINE, TIMES, Array, away, between, checked

from peers import exudyn_beam
from pliant.envs import scenes
from pliant.plants import LargeDeflectionBeam
from pliant.plants.integration.batch_stepper import compile_motions, step_kernel
from pliant.plants.motions import played_motion
from pliant.plants.motions.observations import compile_observations
from pliant.plants.native.batch_kernels import Workspace
from pliant.plants.native.kernel_loader import NativeWarning

GROUP = "cantilever"


@dataclass(frozen=True)
class Strain:
    """Pliant: an exact rotation field in a few coordinates, quadrature points, fixed steps."""

    modes: int
    points: int
    steps: int
    method: str = "rk4"

    def __str__(self) -> str:
        step = 1e3 * END / self.steps
        return f"{self.modes} coordinates, {self.points} points, {self.steps} {self.method} steps of {step:.3g} ms"


OURS = {COARSE: Strain(4, 7, 106), FINE: Strain(7, 14, 150, "rk8")}  # half their step keeps the error too
SIMULATED = {COARSE: Strain(4, 7, 120), FINE: Strain(7, 14, 180, "rk8")}  # whole steps of a control period
FEWER = Strain(3, 7, 115)  # below COARSE by luck: with shorter steps it is not


def name(program: str, error: float, more: str = "") -> str:
    """Of a row."""
    return f"{program}, {error:g} m{more}"


def beam(strain: Strain) -> LargeDeflectionBeam:
    return dataclasses.replace(LargeDeflectionBeam.textbook(), modes=strain.modes, points=strain.points)


def workspace(strain: Strain) -> Workspace:
    with warnings.catch_warnings():  # the truth is too large to be compiled, which is no news
        warnings.simplefilter("ignore", NativeWarning)
        return step_kernel(beam(strain), strain.method, np.dtype(np.float64), lanes=1).workspace(1)


def tip(strain: Strain) -> Array:
    """u and v (601, 2) [m] of a run by the kernel that is timed."""
    plant, work = beam(strain), workspace(strain)
    every = max(1, strain.steps // (len(TIMES) - 1))  # steps in one call
    x = [np.zeros(plant.nx)]
    for _ in range(strain.steps // every):
        work.set(1, x[-1])
        work.run((END / strain.steps,), every)
        x.append(work.get(0)[0].copy())
        if not np.abs(x[-1]).max() < 1e3:
            return np.full((len(TIMES), 2), np.nan)
    y = plant.measure(np.array(x))
    at = [[s.name for s in plant.outputs].index(n) for n in ("tip_u", "tip_v", "tip_u_rate", "tip_v_rate")]
    return between(np.linspace(0.0, END, len(x)), y[:, at[:2]], y[:, at[2:]])


@cache
def truth() -> Array:
    """Of the inextensible beam, (601, 2)."""
    return checked(tip(Strain(14, 29, 6000)), "M0_inextensible")


@cache
def error(strain: Strain) -> float:
    """Of Pliant's run [m]."""
    return away(tip(strain), truth())


def pliant(strain: Strain, allowed: float) -> Sampler:
    """One run from the start at rest."""
    found = error(strain)
    if not found <= allowed:
        raise FloatingPointError(f"cantilever: {strain}: error {found:.2g} m, allowed {allowed:g} m")
    work, step = workspace(strain), (END / strain.steps,)
    start = np.zeros(2 * strain.modes)

    def run() -> None:
        work.set(1, start)
        work.run(step, strain.steps)

    return time_of(run)


def simulated(strain: Strain, allowed: float) -> Sampler:
    """The same by the public call, outputs at the scene's control times; its kernels are built before."""
    found = error(strain)
    if not found <= allowed:
        raise FloatingPointError(f"cantilever: {strain}: error {found:.2g} m, allowed {allowed:g} m")
    scene = scenes.get("cantilever-drop", plant=beam(strain))
    compile_motions(scene.plant, np.inf)
    compile_observations(scene.plant, np.inf)
    played_motion.program.at_hand(np.inf)
    held = np.zeros((len(scene.times), scene.plant.nu))
    run = partial(scene.plant.simulate, scene.initial[0], held, scene.times)
    run = partial(run, method=strain.method, step=END / strain.steps)
    if not run().stats["native"]:
        raise RuntimeError("cantilever: simulate did not run on compiled code")
    return time_of(run)


LUCKY, HALVED = "", ", half the step too"
SIMULATE = ", through simulate"


def cases() -> Iterator[Case]:
    for allowed, strain in OURS.items():
        yield Case(group=GROUP, name=name("Pliant", allowed), unit=TIME, prepare=partial(pliant, strain, allowed))
        through, own = SIMULATED[allowed], name("Pliant", allowed, SIMULATE)
        yield Case(group=GROUP, name=own, unit=TIME, prepare=partial(simulated, through, allowed))
        for more in (LUCKY, HALVED):
            yield Case(
                group=GROUP,
                name=name("Exudyn", allowed, more),
                unit=TIME,
                peer=True,
                prepare=partial(exudyn_beam.solver, allowed, more == HALVED),
            )
    few = name("Pliant", COARSE, f", {FEWER.modes} coordinates")
    yield Case(group=GROUP, name=few, unit=TIME, prepare=partial(pliant, FEWER, COARSE))


def times_faster(rows: Sequence[Row], allowed: float, more: str = LUCKY, own: str = "") -> float | None:
    """Exudyn's time over Pliant's; None where either is missing."""
    found = {row.name: row for row in rows if row.group == GROUP}
    return ratio(found.get(name("Exudyn", allowed, more)), found.get(name("Pliant", allowed, own)))


def notes(rows: Sequence[Row]) -> list[str]:
    """Settings and errors of every row, and the ratio where Exudyn's errors do not cancel."""
    settings: dict[str, Callable[[], str]] = {}
    for allowed, strain in (*OURS.items(), (COARSE, FEWER)):
        more = f", {strain.modes} coordinates" if strain is FEWER else ""
        settings[name("Pliant", allowed, more)] = partial(_described, strain, error)
    for allowed in OURS:
        settings[name("Pliant", allowed, SIMULATE)] = partial(_described, SIMULATED[allowed], error)
        for more in (LUCKY, HALVED):
            settings[name("Exudyn", allowed, more)] = partial(_exudyn_described, allowed, more == HALVED)
    said = [f"{row.name}: {settings[row.name]()}." for row in rows if row.group == GROUP and row.samples]
    for allowed in OURS:
        times = times_faster(rows, allowed, HALVED)
        if times is not None:
            said.append(
                f"Exudyn's fastest settings live on errors of space and time that cancel. Where half its step keeps "
                f"{allowed:g} m too, as it does with Pliant's settings, Pliant is {times:.0f} times faster."
            )
    return said


def _described(chosen: Any, measure: Callable[[Any], float]) -> str:
    return f"{chosen}, largest error {measure(chosen):.2g} m"


def _exudyn_described(allowed: float, settled: bool) -> str:
    return _described(exudyn_beam.best(allowed, settled), exudyn_beam.error)

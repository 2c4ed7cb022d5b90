"""Exudyn's beam elements on the scene cantilever-drop, and a search for its fastest settings within an error.

The model is that of `pliant.studies.peers.exudyn_beams`. Its errors of space and of time have opposite signs: the
fastest settings lie where they happen to cancel. Settings are called settled where halving the step keeps the error
too.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np
from harness.sampling import Sampler, time_of
from harness.tip_error import COARSE, END, FINE, TIMES, Array, away, between, checked

from pliant.envs import scenes
from pliant.studies.peers.exudyn_beams import Solver, System
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import BrokenDownError, Setting


@dataclass(frozen=True)
class Elements:
    """3-node geometrically exact elements in the plane, trapezoidal rule, modified Newton."""

    elements: int
    steps: int
    sparse: bool
    tolerance: float = 1e-4  # of the Newton iteration, relative; the absolute one is 1e-6

    def __str__(self) -> str:
        algebra = "sparse" if self.sparse else "dense"
        step = 1e3 * END / self.steps
        return f"{self.elements} elements, {self.steps} steps of {step:.3g} ms, {algebra}, Newton to {self.tolerance:g}"


SEARCHED = {
    COARSE: [(n, k) for n in (3, 4, 5, 6, 7, 8) for k in (200, 220, 240, 260, 300, 350, 400, 500)],
    FINE: [(n, k) for n in (10, 11, 12, 13, 14, 16) for k in (1200, 1300, 1400, 1500, 1600, 1800, 2000, 2500, 3000)],
}
SETTLED = {
    COARSE: [(n, k) for n in (6, 7, 8, 9, 10) for k in (350, 400, 450, 500)],
    FINE: [(n, k) for n in (20, 22, 24, 28) for k in (2500, 3000, 3500, 4000, 5000)],
}


def system(chosen: Elements, watched: bool) -> System:
    """Assembled; its shear coefficient is the reference's, 1. A step is what it calls a control period."""
    found = machine_of(scenes.get("cantilever-drop"))
    beam = dataclasses.replace(found.links[0], shear_coefficient=1.0)
    held = np.zeros((chosen.steps, 2))
    machine = dataclasses.replace(found, links=(beam,), dt=END / chosen.steps, held=held)
    solver = Solver(tolerance=chosen.tolerance, sparse=chosen.sparse)
    return System(machine, Setting(chosen.elements, 1, solver), 1.0, watched)


@cache
def tip(chosen: Elements) -> Array:
    """u and v (601, 2) [m]; NaN where Exudyn gives up."""
    played = system(chosen, True)
    try:
        played.solve()
    except BrokenDownError:
        return np.full((len(TIMES), 2), np.nan)
    moved, rate = played.motion()[0], played.tip_rate()
    return between(np.linspace(0.0, END, len(moved)), moved - [played.machine.links[0].length, 0.0], rate)


@cache
def truth() -> Array:
    """Of the extensible, shearable beam, (601, 2)."""
    return checked(tip(Elements(40, 24_000, True, 1e-6)), "M1_timoshenko")


def error(chosen: Elements) -> float:
    """Of Exudyn's run [m]."""
    return away(tip(chosen), truth())


def _seconds(chosen: Elements) -> float:
    """The quickest of three solves."""
    played = system(chosen, False)
    return min(played.solve() for _ in range(3))


@cache
def best(allowed: float, settled: bool) -> Elements:
    """Exudyn's fastest settings within the error; settled: with half the step too."""

    def within(chosen: Elements) -> bool:
        halved = dataclasses.replace(chosen, steps=2 * chosen.steps)
        return error(chosen) <= allowed and (not settled or error(halved) <= allowed)

    def fastest(tried: Iterable[Elements], most: int) -> list[Elements]:
        return sorted((e for e in tried if within(e)), key=_seconds)[:most]

    grid = (SETTLED if settled else SEARCHED)[allowed]
    first = fastest((Elements(n, k, n > 11) for n, k in grid), 3)
    variants = [
        dataclasses.replace(e, sparse=sparse, tolerance=tolerance)
        for e in first
        for sparse in (False, True)
        for tolerance in (1e-3, 1e-4, 1e-5)
    ]
    found = fastest(variants, 1)
    if not found:
        raise FloatingPointError(f"no setting within {allowed:g} m")
    return found[0]


def solver(allowed: float, settled: bool) -> Sampler:
    """One solve from the start at rest."""
    return time_of(system(best(allowed, settled), False).solve)

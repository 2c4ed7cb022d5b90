"""What a spacecraft of many appendages costs: building its linear model, and one linearisation against its states."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import numpy as np
from harness.sampling import TIME, Case, Row, Sampler, time_of

from pliant.plants import Beam
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.hub import Hub

GROUP = "spacecraft"
COUNTS = (1, 2, 5, 10, 20)
MODES = (2, 2)  # of each boom, in plane and out
BUILD = f"build and first linearisation, {COUNTS[-1]} appendages of 4 modes"
BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)


def craft(count: int) -> FlexibleSpacecraft:
    """A hub with `count` booms around it, each with four modes and its shortening."""
    parts = []
    for k in range(count):
        c, s = np.cos(0.3 * k), np.sin(0.3 * k)
        turn = ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))
        parts.append(Appendage(position=(c, s, 0.1 * k), orientation=turn, body=BOOM, modes=MODES))
    return FlexibleSpacecraft(hub=Hub(mass=500.0, inertia=(200.0, 150.0, 180.0)), appendages=tuple(parts))


def state(plant: FlexibleSpacecraft) -> np.ndarray:
    """Turning slowly, bent a little."""
    x = 0.01 * np.random.default_rng(0).normal(size=plant.nx)
    x[plant.layout.quaternion] = [1.0, 0.0, 0.0, 0.0]
    return x


def states(count: int) -> int:
    """Of the linear model."""
    return len(craft(count).deviations)


def linearise_name(count: int) -> str:
    return f"linearise, {count} appendage{'s' * (count > 1)} of 4 modes, {states(count)} states"


def linearise(count: int) -> Sampler:
    plant = craft(count)
    x = state(plant)
    return time_of(lambda: plant.linearize(x))


def build() -> Sampler:
    """Seconds from the parameters to the first linear model, each sample anew."""

    def sample(seconds: float) -> float:
        began = time.perf_counter()
        plant = craft(COUNTS[-1])
        plant.linearize(state(plant))
        return time.perf_counter() - began

    return sample


def exponent(rows: Sequence[Row]) -> float | None:
    """k of time ~ states^k where it is largest: between neighbours of COUNTS."""
    points = []
    for count in COUNTS:
        row = next((r for r in rows if (r.group, r.name) == (GROUP, linearise_name(count))), None)
        if row is None or row.median is None:
            return None
        points.append((states(count), row.median))
    return max(float(np.log(b / a) / np.log(m / n)) for (n, a), (m, b) in pairwise(points))


def cases() -> Iterator[Case]:
    def prepared(count: int) -> Callable[[], Sampler]:
        return lambda: linearise(count)

    for count in COUNTS:
        yield Case(group=GROUP, name=linearise_name(count), prepare=prepared(count), unit=TIME)
    yield Case(group=GROUP, name=BUILD, prepare=build, unit=TIME, rounds=3)

"""Which settings of a variant are tried, in which order, and what share of the budget each part of them has.

What a user runs first: `simulate` in compiled code, then the stepper, then linear models at hand, and methods that have
no compiled form last. In each part coarse steps come before fine ones. A part that does not use up its share leaves the
rest to those behind it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pliant.plants import Plant
from pliant.studies.fidelity.speed_accuracy import LANES, SUBSTEPS, TOLERANCES, Row

EXPLICIT, IMPLICIT = (
    ("dop853", "rk4", "rk8"),
    ("rosenbrock", "rodas5p"),
)  # compiled; the latter in the budget
STEPPED_NATIVELY = ("rk4", "rk8")  # by `simulate`, in the same library as dop853
STEPPED = (("rk4", "double"), ("rk4", "single"), ("rk8", "double"), ("rk8", "single"))
LONG = (("rosenbrock", "double"),)  # a kernel in single precision takes as long to compile again
LEVELS = len(SUBSTEPS)
NODES = (1, 5)  # of a model along a motion, a control period


@dataclass(frozen=True)
class Part:
    """Settings that share a part of the budget, each a variant and its row without numbers."""

    until: float  # share of the budget at which it ends
    settings: tuple[tuple[Plant, Row], ...]


def simulated(plant: Plant, method: str, level: int, dt: float) -> Row | None:
    """`simulate` by a method at its `level`-th setting; None where it has none."""
    if method in TOLERANCES:
        if level >= len(TOLERANCES[method]):
            return None
        return Row(plant.label, plant.nx, method, None, TOLERANCES[method][level])
    return Row(plant.label, plant.nx, method, dt / SUBSTEPS[level], None)


def parts(plants: Sequence[Plant], methods: Sequence[str], dt: float) -> tuple[Part, ...]:
    """Every setting of all variants; `dt` [s] is the control period."""
    explicit = [m for m in methods if m in EXPLICIT]
    implicit = [m for m in methods if m in IMPLICIT]
    slow = [m for m in methods if m not in (*EXPLICIT, *IMPLICIT)]
    return (
        Part(0.25, tuple(_simulate(plants, explicit, dt))),
        Part(0.6, tuple(_stepper(plants, STEPPED, methods, dt))),
        Part(0.7, tuple(_simulate(plants, implicit, dt))),
        Part(0.75, tuple(_stepper(plants, LONG, methods, dt))),
        Part(0.9, tuple(_linear(plants, dt))),
        Part(1.0, tuple(_simulate(plants, slow, dt))),
    )


def _simulate(plants: Sequence[Plant], methods: Sequence[str], dt: float) -> Iterator[tuple[Plant, Row]]:
    for level in range(LEVELS):
        for method in methods:
            for plant in plants:
                row = simulated(plant, method, level, dt)
                if row is not None:
                    yield plant, row


def _stepper(
    plants: Sequence[Plant], kinds: Sequence[tuple[str, str]], methods: Sequence[str], dt: float
) -> Iterator[tuple[Plant, Row]]:
    for method, precision in kinds:
        if method not in methods:
            continue
        for k in SUBSTEPS:
            for plant in plants:
                for lanes in LANES:
                    at = {"path": "stepper", "lanes": lanes, "precision": precision}
                    yield plant, Row(plant.label, plant.nx, method, dt / k, None, **at)  # type: ignore[arg-type]


def _linear(plants: Sequence[Plant], dt: float) -> Iterator[tuple[Plant, Row]]:
    """Those with many nodes, which take long to make, last."""
    for method, apart in (("linear", None), ("reduced", None), *(("ltv", dt / k) for k in NODES)):
        for plant in plants:
            yield plant, Row(plant.label, plant.nx, method, apart, None, path="linear")

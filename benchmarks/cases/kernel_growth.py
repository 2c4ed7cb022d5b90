"""RK4 kernels against the number of states: both arms with 1 to 8 modes a link, strain beams of 3 to 14 coordinates.

Operations: sums, products, quotients and function calls of one right-hand side. Share of peak: operations, each one
slot of a unit of fused multiply-adds, over the core's measured peak (`fma_peak.py`). Bytes: of the compiled library,
and of the table through which the parts of a long right-hand side pass values, a block of lanes.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, partial
from statistics import median

import casadi as ca
import numpy as np
from harness.sampling import Case, Row, Sampler, rate_of
from harness.table import grid, number
from matplotlib.figure import Figure

from pliant.envs import scenes
from pliant.plants import LargeDeflectionBeam, Plant, SingleLinkArm
from pliant.plants.integration.batch_stepper import rate_function, step_kernel
from pliant.studies.figures import style

GROUP, LANES, STEP, EVALUATIONS = "growth", 1024, 1e-8, 4
TWO = scenes.get("two-link-reach").plant
ONE = dataclasses.replace(SingleLinkArm.textbook(), kinematics="stiffened", basis="payload")
MODES, COORDINATES = (1, 2, 4, 6, 8), (3, 4, 6, 8, 10, 12, 14)
SILENT = (ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_ASSIGN)
FAMILIES: dict[str, tuple[Sequence[int], Callable[[int], Plant]]] = {
    "two links, stiffened": (MODES, lambda n: dataclasses.replace(TWO, modes=(n, n))),
    "one link, stiffened": (MODES, lambda n: dataclasses.replace(ONE, modes=n)),
    "two links, exact rotations": (
        MODES,
        lambda n: dataclasses.replace(TWO, modes=(n, n), kinematics="strain", basis="polynomial"),
    ),
    "one link, exact rotations": (
        MODES,
        lambda n: dataclasses.replace(ONE, modes=n, kinematics="strain", basis="polynomial"),
    ),
    "strain beam": (
        COORDINATES,
        lambda n: dataclasses.replace(LargeDeflectionBeam.textbook(), kinematics="strain", modes=n),
    ),
}


@lru_cache(maxsize=64)
def plant(name: str) -> Plant:
    """The plant of a row, "family, n"."""
    family, _, n = name.rpartition(", ")
    return FAMILIES[family][1](int(n))


@lru_cache(maxsize=64)
def operations(name: str) -> int:
    """Of one right-hand side."""
    rate = rate_function(plant(name))
    return sum(rate.instruction_id(k) not in SILENT for k in range(rate.n_instructions()))


def names() -> list[str]:
    """Of all rows."""
    return [f"{family}, {n}" for family, (sizes, _) in FAMILIES.items() for n in sizes]


def sampler(name: str) -> Sampler:
    """Steps a second of 1,024 lanes on one thread, near rest; RuntimeError where the virtual machine runs."""
    kernel = step_kernel(plant(name), "rk4", np.dtype(float))
    if not kernel.native:
        raise RuntimeError(f"{name}: its kernel is not native")
    work = kernel.workspace(LANES)
    work.set(1, 1e-6 * np.random.default_rng(0).uniform(-1.0, 1.0, (LANES, plant(name).nx)))

    def run() -> int:
        work.run((STEP,), 1, 1)
        return LANES

    return rate_of(run)


def cases() -> Iterator[Case]:
    for name in names():
        yield Case(group=GROUP, name=name, lanes=LANES, prepare=partial(sampler, name))


def sizes(name: str) -> tuple[int, int]:
    """Bytes of the library and of the table between parts."""
    kernel = step_kernel(plant(name), "rk4", np.dtype(float))
    if kernel.kernel is None or kernel.source is None:
        return 0, 0
    found = kernel.source().split("T between[")
    rows = int(found[1].split("]")[0]) if len(found) > 1 else 0
    return kernel.kernel.path.stat().st_size, rows * kernel.lanes * kernel.dtype.itemsize


def share(row: Row, peak: Row | None) -> float | None:
    """Of the peak, round by round."""
    if peak is None or not row.samples or not peak.samples:
        return None
    each = EVALUATIONS * operations(row.name)
    return median(each * a / b for a, b in zip(row.samples, peak.samples))


def growth(rows: Sequence[Row]) -> dict[str, float]:
    """Exponent of a step's time between the smallest and the largest of each family, by its states."""
    found = {}
    for family in FAMILIES:
        own = [r for r in rows if r.group == GROUP and r.name.rpartition(", ")[0] == family and r.median]
        if len(own) > 1:
            first, last = own[0], own[-1]
            states = plant(last.name).nx / plant(first.name).nx
            found[family] = float(np.log((first.median or 0) / (last.median or 1)) / np.log(states))
    return found


def lines(rows: Sequence[Row], peak: Row | None) -> list[str]:
    """The table in markdown."""
    cells = []
    for row in rows:
        part = share(row, peak)
        library, table = sizes(row.name)
        cells.append(
            [
                row.name,
                str(plant(row.name).nx),
                f"{operations(row.name):,}",
                number(row.median),
                "-" if part is None else f"{100 * part:.0f} %",
                f"{library / 1e3:.0f}",
                f"{table / 1e3:.1f}",
            ]
        )
    head = ["", "states", "operations", "steps/s", "share of peak", "library [kB]", "between parts [kB]"]
    powers = ", ".join(f"{family} {power:.1f}" for family, power in growth(rows).items())
    return [*grid(head, cells, 1), "", f"A step's time grows by the power of the states: {powers}."]


@style.styled
def chart(rows: Sequence[Row]) -> Figure:
    """Steps a second and operations against states, with cubes of the states beside."""
    figure, axes = style.panels(2, height=2.9)
    for k, family in enumerate(FAMILIES):
        own = [r for r in rows if r.name.rpartition(", ")[0] == family and r.median]
        if not own:
            continue
        states = [plant(r.name).nx for r in own]
        mark = {"marker": "osD^v"[k], "color": style.COLOURS[k], "markersize": 4, "label": family}
        axes[0].plot(states, [r.median for r in own], **mark)
        axes[1].plot(states, [operations(r.name) for r in own], **mark)
    for axis, label, power, at in zip(axes, ("steps/s, 1,024 lanes", "operations"), (-3, 3), (1e8, 100.0)):
        states = np.array([6.0, 36.0])
        axis.plot(states, at * (states / 6) ** power, "k:", linewidth=0.8, label="cube of the states")
        axis.set(xscale="log", yscale="log", ylabel=label, xticks=[4, 6, 8, 12, 18, 28, 36])
        axis.set_xticklabels([4, 6, 8, 12, 18, 28, 36])
        axis.minorticks_off()
    axes[0].set_title("RK4 kernels on one core against the number of states")
    axes[0].legend(fontsize=7, loc="lower left")
    axes[1].set_xlabel("states")
    return figure

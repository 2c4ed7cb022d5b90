"""Trees of 6 to 48 speeds: chains of rigid links, stars of booms that bend on a free platform, RK4 steps on one thread.

Operations of a right-hand side as it is solved, and as M a = r takes with one factorisation in the order of the
coordinates.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache, partial

import casadi as ca
import numpy as np
from harness.sampling import RATE, Case, Row, Sampler, rate_of

from pliant.plants import Beam, FlexibleTree, Joint, Payload, TreeBody
from pliant.plants.dynamics.symbolic_ldl import ldl, ldl_solve

from .kernel_growth import SILENT

GROUP, LANES = "trees", 1024
CHAINS, STARS = (6, 12, 24, 48), ((2, 2), (6, 2), (6, 6))  # joints; (booms, shapes of each)
BOOM = Beam(length=3.0, area=8e-5, I_y=1e-10, I_z=2.7e-9, J=4e-10, density=2700.0, E=70e9, G=26e9, damping=1e-4)
SHAPES = {2: (1, 1, 0, 0), 6: (2, 2, 2, 0)}


def chain(n: int) -> FlexibleTree:
    """Links of a metre about z and y in turn."""
    bodies = [
        TreeBody(
            name=f"b{k}",
            joint=Joint(name=f"j{k}", axis=((0, 0, 1), (0, 1, 0))[k % 2], position=(float(k > 0), 0, 0)),
            mass=1.0,
            centre=(0.5, 0.0, 0.0),
            inertia=((0.01, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)),
        )
        for k in range(n)
    ]
    return FlexibleTree.serial(bodies)


def star(booms: int, shapes: int) -> FlexibleTree:
    """Hinged booms around a free platform."""
    bodies = []
    for k in range(booms):
        turn = 2 * np.pi * k / booms
        position = (float(np.cos(turn)), float(np.sin(turn)), 0.1)
        hinge = Joint(name=f"j{k}", axis=(0, 1, 0), position=position, rotation=(0, 0, turn))
        bodies.append(TreeBody(name=f"b{k}", parent="base", joint=hinge, beam=BOOM, modes=SHAPES[shapes]))
    platform = Payload(mass=500.0, inertia=200.0)
    return FlexibleTree(bodies=tuple(bodies), base="free", platform=platform, gravity=(0, 0, 0))


@cache
def trees() -> dict[str, FlexibleTree]:
    """By what the rows call them."""
    found = {f"chain of {n} joints": chain(n) for n in CHAINS}
    for booms, shapes in STARS:
        made = star(booms, shapes)
        found[f"star of {booms} booms, {len(made.speeds)} speeds"] = made
    return found


def count(tree: FlexibleTree, found: ca.SX) -> int:
    """Operations of an expression."""
    f = ca.Function("f", list(tree.symbols), ca.cse([found]))
    return sum(f.instruction_id(k) not in SILENT for k in range(f.n_instructions()))


@cache
def operations(name: str) -> tuple[int, int]:
    """(as it is solved, by one factorisation)."""
    tree = trees()[name]
    symbols = tree.symbols[:4]
    M, r, _, _ = tree.equations(*symbols)
    return count(tree, tree.solved(*symbols)[0]), count(tree, ldl_solve(*ldl(M), r))


def steps(name: str) -> Sampler:
    """RK4 steps of many lanes at rest."""
    tree = trees()[name]
    x = tree.state() if tree.turns else np.zeros(tree.nx)
    X, U = np.asfortranarray(np.tile(x, (LANES, 1))), np.zeros((LANES, tree.nu), order="F")
    step = tree.stepper(1e-6, batch=LANES, threads=1)

    def run() -> int:
        step(X, U)
        return LANES

    return rate_of(run)


def cases() -> Iterator[Case]:
    for name in trees():
        yield Case(group=GROUP, name=f"RK4 step, {name}", unit=RATE, lanes=LANES, prepare=partial(steps, name))


def notes(rows: Sequence[Row]) -> list[str]:
    """Operations against speeds."""
    if not any(row.group == GROUP for row in rows):
        return []
    each = ", ".join("{}: {:,} (one factorisation: {:,})".format(name, *operations(name)) for name in trees())
    return [f"Operations of a right-hand side: {each}."]

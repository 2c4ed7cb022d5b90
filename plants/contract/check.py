"""`check(plant)`: whether a plant keeps what the library relies on, clause by clause, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

from pliant.plants.core.argument_gates import require_count, require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.dynamics.plant import Plant

from . import declared_names, equations


class ContractError(PliantError, ValueError):
    """A plant breaks what the library relies on; `faults` says each."""

    def __init__(self, message: str, faults: tuple[str, ...]) -> None:
        super().__init__(message)
        self.faults = faults


@dataclass(frozen=True)
class Checked:
    """What was checked of a plant, and what was found; print it."""

    plant: str
    found: tuple[tuple[str, str], ...]  # (clause, what was found)

    def __str__(self) -> str:
        wide = max(len(clause) for clause, _ in self.found)
        return "\n".join([self.plant, *(f"  {clause:<{wide}}  {words}" for clause, words in self.found)])


def check(plant: Plant, *, points: int = 4, seed: int = 0) -> Checked:
    """Hold a plant's word against its equations, at random `points` drawn from `seed`, on every rung of its ladder.

    Signals and their names; every name that it answers with; `ladder` with the same inputs and outputs on every rung;
    sizes and finite numbers of `ode` and `output`; Jacobians against differences; the energy balance and the mass
    matrix of mechanical plants; `outline`. docs/own_plant.md says what each is for.

    ContractError, which lists every fault in words. What holds at some points is not shown to hold at others.

    >>> print(str(check(arm)).splitlines()[0])
    SingleLinkArm (stiffened, payload 2)
    """
    require_instance("check.plant", plant, Plant)
    count = require_count("check", "points", points, 1, 1000)
    start = require_count("check", "seed", seed, 0, 2**32)
    name = f"{type(plant).__name__} ({plant.label})" if isinstance(plant.label, str) else type(plant).__name__
    faults: list[str] = []
    found: list[tuple[str, str]] = []

    def clause(title: str, wrong: Callable[[], Iterable[str]], well: Callable[[], str]) -> bool:
        """Whether a clause holds; whatever a user's method raises is a fault of it."""
        try:
            new = list(wrong())
        except Exception as failed:
            new = [f"{title}: {type(failed).__name__}: {failed}"]
        if not new:
            found.append((title, well()))
        faults.extend(new)
        return not new

    if not clause("signals", lambda: declared_names.wrong_signals(plant), lambda: _counts(plant)):
        raise ContractError("\n  ".join([f"{name} breaks the contract of plants:", *faults]), tuple(faults))
    at: list[dict[str, Any]] = []

    def sizes() -> Iterable[str]:
        rate, output = plant.expressions
        whole = (rate.numel(), output.numel()) == (plant.nx, plant.ny)
        if whole and equations.wrong_rest(plant) is None:  # else no point can be drawn
            at.extend(equations.points(plant, count, start))
        return equations.wrong_sizes(plant, at)

    if clause("equations", sizes, lambda: f"finite at rest and at {len(at)} random points"):
        told: dict[str, str] = {}

        def slopes() -> list[str]:
            worst, wrong = equations.derivatives(plant, at)
            told["slopes"] = f"agree with differences {equations.within(worst)}"
            return wrong

        def energy() -> list[str]:
            told["energy"], wrong = equations.energy_balance(plant, at)
            return wrong

        clause("mass matrix", lambda: equations.wrong_masses(plant, at), lambda: _massive(plant))
        clause("derivatives", slopes, lambda: told["slopes"])
        clause("energy", energy, lambda: told["energy"])
        clause("names", lambda: declared_names.wrong_names(plant), lambda: _answers(plant))
        clause("outline", lambda: equations.wrong_outline(plant, at), lambda: _drawn(plant))
    if clause("ladder", lambda: declared_names.wrong_ladder(plant), lambda: _rungs(plant)):
        for rung in plant.ladder():
            if rung != plant:
                clause(f"rung {rung.label!r}", partial(_of_rung, rung), lambda: "finite at rest")
    clause("travels", lambda: declared_names.wrong_travel(plant), lambda: "a pickled copy is equal")
    if faults:
        raise ContractError("\n  ".join([f"{name} breaks the contract of plants:", *faults]), tuple(faults))
    return Checked(name, tuple(found))


def _of_rung(rung: Plant) -> list[str]:
    """What is wrong with another rung's signals and equations."""
    wrong = [*declared_names.wrong_signals(rung), *equations.wrong_sizes(rung, [])]
    return [f"ladder(): {rung.label!r}: {words}" for words in wrong]


def _counts(plant: Plant) -> str:
    return f"{plant.nx} states, {plant.nu} inputs, {plant.nw} disturbances, {plant.ny} outputs"


def _massive(plant: Plant) -> str:
    return "symmetric, positive definite" if hasattr(plant, "mass_matrix") else "it states none"


def _answers(plant: Plant) -> str:
    joints = ", ".join(f"{j.input} drives {j.position}" for j in plant.joints) or "no input drives one coordinate alone"
    return f"{joints}; sensors: {', '.join(f'{s.device} of {s.signal}' for s in plant.sensors()) or 'none'}"


def _drawn(plant: Plant) -> str:
    lines = len(plant.outline(plant.rest_state, 2))
    return f"{lines} lines" if lines else "none: the plant is not drawn"


def _rungs(plant: Plant) -> str:
    rungs = plant.ladder()
    return f"{len(rungs)} rungs of the same inputs and outputs" if len(rungs) > 1 else "one rung"

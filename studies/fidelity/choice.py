"""The smallest model for a scene: climb the plant's ladder until finer rungs no longer change its outputs.

Two neighbouring rungs may agree because both lack the same effect: one and two bending modes without the
shortening of the bent links agree with each other, and both are wrong. So a rung is taken only when it agrees
with the *finest* one, which holds every effect of the ladder, and the finest rung itself must be confirmed by
another variant. The error bound of a rung is its difference from the finest plus that shown convergence.

A rung whose own motion leaves the range of its kinematics (`Plant.validity`) is not taken, whatever it agrees with; and
where the finest leaves its own, no rung is shown to be right.
"""

from __future__ import annotations

import dataclasses
import time as clock
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant
from pliant.plants.core.argument_gates import require_function, require_instance, require_number
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.studies.common.formatting import measured as in_unit
from pliant.studies.common.reference_motions import Motions, Progress, share, silent

from .speed_accuracy import METHODS, SUBSTEPS, TOLERANCES, Chart, Row, Runner, chart

# (field, value that brings the effect in) -> words; None: any value
EFFECTS = {
    ("kinematics", "stiffened"): "shortening of the bent links",
    ("kinematics", "linear"): "bending",
    ("reduction", "full"): "bending",
    ("modes", None): "modes",
    ("appendages", None): "modes",
    ("basis", None): "shape functions",
}
STEP_SEARCH = 4.0  # [s] for the largest step


@dataclass(frozen=True)
class Rung:
    """One variant of the ladder; differences in the compared outputs' unit."""

    variant: str
    states: int
    change: float | None  # to the next finer rung
    error: float  # from the finest rung
    bound: float  # error plus the shown convergence of the finest
    chosen: bool = False
    note: str = ""
    outside: str = ""  # which ranges of its kinematics its own motion leaves


@dataclass(frozen=True)
class Effect:
    """What one field of the chosen plant is worth: the change of the outputs when it alone is changed."""

    name: str
    field: str
    chosen: str  # the chosen plant's value
    other: str
    change: float
    kept: bool  # in the chosen plant; else left out of it


@dataclass(frozen=True)
class Choice:
    """The chosen plant and why. `met` is False where no rung could be shown to keep the tolerance."""

    scene: str
    compare: tuple[str, ...]
    tolerance: float
    plant: Plant = field(repr=False)
    met: bool
    rungs: tuple[Rung, ...]
    effects: tuple[Effect, ...]
    confirmed_by: str  # the variant nearest to the finest ..
    convergence: float  # .. and their difference
    integrator: Row | None  # the fastest within the tolerance, of the chosen plant
    largest_step: Row | None  # the fixed-step method with the largest step within it
    text: str
    unit: str = "m"  # of the compared outputs, differences and tolerance

    def to_json(self) -> dict[str, Any]:
        content = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "plant"}
        for name in ("rungs", "effects"):
            content[name] = [asdict(item) for item in content[name]]
        for name in ("integrator", "largest_step"):
            content[name] = None if content[name] is None else asdict(content[name])
        return {"chosen": self.plant.label, "states": self.plant.nx, **content}


def choose(
    scene: Scene,
    tolerance: float | None = None,
    *,
    measured: Chart | None = None,
    motions: Motions | None = None,
    progress: Progress | None = None,
) -> Choice:
    """The cheapest rung whose error bound is within `tolerance` [unit of scene.compare; None: the scene's].

    Also the fastest integrator and the largest fixed step that keep it; the first from `measured`, or from a
    short chart of that rung. Where none is shown to keep it the finest is returned with met=False. ValueError for a
    tolerance not above 0.
    """
    require_instance("choose.scene", scene, Scene)
    tolerance = scene.tolerance if tolerance is None else tolerance
    tolerance = require_number("choose.tolerance", tolerance, "positive", scene.unit)
    if measured is not None:
        require_instance("choose.measured", measured, Chart)
    if motions is not None:
        require_instance("choose.motions", motions, Motions)
    if progress is not None:
        require_function("choose.progress", progress)
    told, motions = progress or silent, motions or Motions(scene)
    ladder = motions.ladder
    for i, plant in enumerate(ladder):
        told(0.5 * i / len(ladder), plant.label)
        motions.difference(plant, plant)
    rungs, chosen = _climb(motions, tolerance)
    plant = ladder[chosen]
    told(0.6, "effects")
    effects = _effects(motions, plant)
    met = _shown(rungs[chosen], rungs[-1], tolerance)
    fastest, largest = None, None
    if met:
        fastest = None if measured is None else measured.fastest(tolerance, plant.label)
        if fastest is None:
            sharp, told_of_it = dataclasses.replace(scene, tolerance=tolerance), share(progress, 0.7, 0.9)
            part = chart(sharp, budget=STEP_SEARCH, variants=(plant,), motions=motions, progress=told_of_it)
            fastest = part.fastest(tolerance, plant.label)
        told(0.9, "largest step")
        largest = _largest_step(motions, plant, tolerance)
    nearest, convergence = motions.shown_convergence
    found = Choice(
        scene=scene.name,
        compare=scene.compare,
        tolerance=float(tolerance),
        plant=plant,
        met=met,
        rungs=rungs,
        effects=effects,
        confirmed_by=nearest,
        convergence=convergence,
        integrator=fastest,
        largest_step=largest,
        text="",
        unit=scene.unit,
    )
    told(1.0, "choice")
    return dataclasses.replace(found, text=_words(found, motions))


def _largest_step(motions: Motions, plant: Plant, tolerance: float) -> Row | None:
    """The fixed-step method with the largest step within the tolerance, of several the fastest."""
    runner = Runner(motions, clock.perf_counter() + STEP_SEARCH, prune=False)
    for level in range(len(SUBSTEPS)):
        rows = [runner.measure(plant, method, level) for method in METHODS if method not in TOLERANCES]
        good = [r for r in rows if r is not None and r.error is not None and r.error <= tolerance]
        if good:
            return min(good, key=lambda r: r.seconds or 0.0)
    return None


def _climb(motions: Motions, tolerance: float) -> tuple[tuple[Rung, ...], int]:
    """The rungs, and which is chosen: the first whose bound is within the tolerance, else the finest."""
    ladder, finest = motions.ladder, motions.reference
    _, convergence = motions.shown_convergence
    rungs: list[Rung] = []
    for i, plant in enumerate(ladder):
        change = motions.difference(plant, ladder[i + 1]) if i + 1 < len(ladder) else None
        error = motions.difference(plant, finest)
        bound = error + convergence
        note = ""
        if change is not None and change <= tolerance < bound:
            note = "agrees with the next rung, not with the finest"
        if plant == finest:
            note = "the finest"
        outside = motions.outside(plant)
        if outside:
            note = f"{note}; leaves its range" if note else "leaves its range"
        rungs.append(Rung(plant.label, plant.nx, change, error, bound, note=note, outside=outside))
    chosen = next((i for i, rung in enumerate(rungs) if _shown(rung, rungs[-1], tolerance)), len(rungs) - 1)
    rungs[chosen] = dataclasses.replace(rungs[chosen], chosen=True)
    return tuple(rungs), chosen


def _shown(rung: Rung, finest: Rung, tolerance: float) -> bool:
    """Whether a rung is shown to keep the tolerance: it and the finest within the ranges of their kinematics."""
    return rung.bound <= tolerance and not rung.outside and not finest.outside


def _effects(motions: Motions, plant: Plant) -> tuple[Effect, ...]:
    """Each field that differs along the ladder, changed alone: to its next cheaper value, to the finest's."""
    ladder = motions.ladder
    found: list[Effect] = []
    for f in dataclasses.fields(plant):
        values = _values(ladder, f.name)
        own = getattr(plant, f.name)
        if len(values) < 2 or own not in values:
            continue
        at = values.index(own)
        finest = getattr(motions.reference, f.name)
        cheaper = [value for value in values[:at] if value != finest]
        others = [(cheaper[-1], True)] if cheaper else []
        if finest != own:
            others.append((finest, False))
        for value, kept in others:
            changed = _changed(plant, f.name, value)
            if changed is None:
                continue
            change = motions.difference(plant, changed)
            bringing = own if kept else value
            if "rigid" in (own, value):
                bringing = "linear"
            name = EFFECTS.get((f.name, bringing)) or EFFECTS.get((f.name, None)) or f.name
            found.append(Effect(name, f.name, _plain(own), _plain(value), change, kept))
    return tuple(sorted(found, key=lambda e: -e.change))


def _changed(plant: Plant, field: str, value: Any) -> Plant | None:
    """The plant with one field changed; None where it may not be, or where that makes no other model."""
    try:
        changed = dataclasses.replace(plant, **{field: value})
    except ValueError:
        return None
    return changed if changed.label != plant.label else None


def _values(ladder: Sequence[Plant], field: str) -> list[Any]:
    """A field's values up the ladder, numbers in order, on the rungs where it matters (a rigid arm has no modes)."""
    values = list(dict.fromkeys(getattr(rung, field) for rung in ladder))
    matter = [rung for rung in ladder if any(_changed(rung, field, value) for value in values)]
    values = list(dict.fromkeys(getattr(rung, field) for rung in matter))
    if all(isinstance(v, int) or (isinstance(v, tuple) and all(isinstance(n, int) for n in v)) for v in values):
        values.sort()
    return values


def _plain(value: Any) -> str:
    if isinstance(value, tuple) and all(isinstance(v, Appendage) for v in value):
        value = tuple(v.data.n for v in value)
    return "+".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _words(choice: Choice, motions: Motions) -> str:
    rung = next(r for r in choice.rungs if r.chosen)
    outputs = " and ".join(choice.compare)

    def said(value: float) -> str:
        return in_unit(value, choice.unit)

    if choice.met:
        lead = (
            f"{rung.variant} ({rung.states} states) is the cheapest variant that keeps {outputs} within "
            f"{said(choice.tolerance)}: it is {said(rung.error)} from the finest, "
            f"{motions.reference.label}"
        )
        lead += "" if choice.plant != motions.reference else " (it is the finest itself)"
    else:
        lead = (
            f"No variant is shown to keep {outputs} within {said(choice.tolerance)}; the finest, "
            f"{rung.variant}, is returned"
        )
    parts = [f"{lead}. The finest is confirmed by {choice.confirmed_by} to {said(choice.convergence)}."]
    left = [e for e in choice.effects if not e.kept]
    kept = [e for e in choice.effects if e.kept]
    if left:
        each = ", ".join(f"{e.name} ({e.other} for {e.chosen}): {said(e.change)}" for e in left)
        parts.append(f"Left out: {each}.")
    if kept:
        each = ", ".join(f"{e.name} ({e.chosen}, not {e.other}): {said(e.change)}" for e in kept)
        parts.append(f"Kept: {each}.")
    if choice.integrator is not None:
        speed = (choice.integrator.seconds or 0.0) * 1e3
        parts.append(f"Fastest integrator within it: {choice.integrator.setting}, {speed:.3g} ms a simulated second.")
    if choice.largest_step is not None:
        parts.append(f"Largest fixed step within it: {choice.largest_step.setting}.")
    finest = choice.rungs[-1]
    for r in choice.rungs:
        if r.outside and (r is finest or r.bound <= choice.tolerance):
            why = "so that nothing is shown by comparing with it" if r is finest else "and is not taken"
            parts.append(f"{r.variant} leaves the range of its kinematics, {why}: {r.outside}.")
    misled = [r for r in choice.rungs if r.note.startswith("agrees")]
    if misled:
        names = "; ".join(r.variant for r in misled)
        parts.append(f"Within the tolerance of the next rung and yet wrong: {names}.")
    return " ".join(parts)

"""The smallest model for a scene: climb from the cheapest to the first that keeps the tolerance against physics.

What physics gives (`physics_motion`: exact rotations, shear, as many shapes as matter) is known with a stated
uncertainty, and every rung's motion is compared with it. Rungs that agree with each other confirm nothing, as they may
lack the same effect. A rung's bound is its difference from physics and that uncertainty; a tolerance is met where the
bound keeps it. What even physics leaves out is named.

Rungs are the plant's ladder, the scene's own plant where its fields are on no rung of it, and physics itself.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core.argument_gates import as_tuple, require_function, require_instance, require_number, shown
from pliant.studies.common.reference_motions import Motions, Progress, share, silent

from . import effects as worth
from .effects import Effect
from .integrators import integrators
from .physics_motion import PhysicsMotion, physics_motion
from .speed_accuracy import Chart, Row
from .verdict_in_words import words

CLIMB = 1e-6  # rtol of a rung's motion
NEAR = 2.0  # times the tolerance: where the integration may decide, it is done again ..
CONFIRMED = 1e-8  # .. at this rtol


@dataclass(frozen=True)
class Rung:
    """One variant; differences in the compared outputs' unit. None: not tried, as a cheaper one keeps the tolerance."""

    variant: str
    states: int
    error: float | None  # from physics, its own uncertainty where it is physics; infinite where either motion fails
    bound: float | None  # error plus the uncertainty of physics
    chosen: bool = False
    note: str = ""
    outside: str = ""  # which ranges of its kinematics its own motion leaves


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
    physics: str  # what errors are measured against, and how it was found
    convergence: float  # its uncertainty
    missing: tuple[str, ...]  # not met: the effects that it takes; met: what even physics leaves out
    integrator: Row | None  # the fastest within the tolerance, of the chosen plant
    largest_step: Row | None  # the fixed-step method with the largest step within it
    text: str
    unit: str = "m"  # of the compared outputs, differences and tolerance

    @property
    def method(self) -> str | None:
        """Of the fastest integrator within the tolerance."""
        return None if self.integrator is None else self.integrator.method

    @property
    def step(self) -> float | None:
        """Its step [s]; None of an adaptive one."""
        return None if self.integrator is None else self.integrator.step

    @property
    def seconds_per_second(self) -> float | None:
        """Its time for a simulated second [s]."""
        return None if self.integrator is None else self.integrator.seconds

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
    motions: Motions | Sequence[Any] | None = None,
    progress: Progress | None = None,
) -> Choice:
    """The cheapest rung whose error bound is within `tolerance` [unit of scene.compare; None: the scene's].

    `motions`: which motions it is to keep it on, each None (the scene's open loop) or a Trajectory, as of a closed
    loop, whose inputs are played at the control times; None: the open loop alone. Also the fastest integrator and the
    largest fixed step that keep it on the first; `measured`, the scene's chart, which tries more methods, is asked for
    the fastest before. Where no rung is shown to keep it, `met` is False, and `missing` says what is missing.
    ValueError for a tolerance not above 0.

    Example
    -------
    >>> found = choose(scenes.get("two-link-reach"), 1e-3)
    >>> found.plant.label, found.met, [(r.variant, r.bound) for r in found.rungs]
    """
    require_instance("choose.scene", scene, Scene)
    tolerance = scene.tolerance if tolerance is None else tolerance
    tolerance = require_number("choose.tolerance", tolerance, "positive", scene.unit)
    if measured is not None:
        require_instance("choose.measured", measured, Chart)
    played = _motions(scene, motions)
    if progress is not None:
        require_function("choose.progress", progress)
    told = progress or silent
    told(0.0, "physics")
    climb = _Climb(played, tolerance)
    rungs, chosen = climb.rungs(share(progress, 0.3, 0.6))
    plant, met = climb.ladder[chosen], climb.shown(rungs[chosen])
    told(0.6, "effects")
    found_effects = worth.of(played[0], climb.physics[0], plant)
    fastest, largest = None, None
    if met and climb.physics[0] is not None:
        told(0.7, "integrator")
        fastest, largest = integrators(played[0], climb.physics[0], plant, tolerance)
        if measured is not None and measured.reference.uncertainty < tolerance:
            charted = measured.fastest(tolerance - measured.reference.uncertainty, plant.label)
            rows = [row for row in (fastest, charted) if row is not None]
            fastest = min(rows, key=lambda row: row.seconds or 0.0, default=None)
    found = Choice(
        scene=scene.name,
        compare=scene.compare,
        tolerance=tolerance,
        plant=plant,
        met=met,
        rungs=rungs,
        effects=found_effects,
        physics=climb.told,
        convergence=climb.uncertainty,
        missing=climb.missing(met, found_effects),
        integrator=fastest,
        largest_step=largest,
        text="",
        unit=scene.unit,
    )
    told(1.0, "choice")
    return dataclasses.replace(found, text=words(found))


def _motions(scene: Scene, given: Any) -> list[Motions]:
    """The motions to keep the tolerance on."""
    if given is None or isinstance(given, Motions):
        return [given or Motions(scene)]
    found = []
    for i, one in enumerate(as_tuple("choose.motions", given)):
        if one is None or isinstance(one, Motions):
            found.append(one or Motions(scene))
            continue
        motion = require_instance(f"choose.motions[{i}]", one, Trajectory)
        if tuple(s.name for s in motion.inputs) != tuple(s.name for s in scene.plant.inputs):
            raise ValueError(f"choose.motions[{i}] has inputs {shown(motion.inputs)}, must have the plant's")
        found.append(Motions(scene, motion.resample(scene.times[scene.times <= motion.t[-1] + 1e-12]).u))
    if not found:
        raise ValueError("choose.motions = () must hold at least one motion")
    return found


class _Climb:
    """Rungs of a scene against physics, on every motion asked for."""

    def __init__(self, played: list[Motions], tolerance: float) -> None:
        self.played, self.tolerance = played, tolerance
        self.physics: list[PhysicsMotion | None] = []
        self.failed = ""
        for motions in played:
            try:
                self.physics.append(physics_motion(motions, tolerance))
            except PliantError as failure:
                self.physics.append(None)
                self.failed = f"physics cannot be played: {failure}"
        known = [p for p in self.physics if p is not None]
        worst = max(known, key=lambda p: p.uncertainty, default=None)
        if self.failed or worst is None:
            self.uncertainty, self.told = float("inf"), self.failed
        else:
            self.uncertainty, self.told = worst.uncertainty, worst.how
        richest = max((p.physics for p in known), key=lambda p: p.nx, default=None)
        self.ladder = _rungs(played[0].scene.plant, richest)
        self.outside = "; ".join(p.outside for p in known if p.outside)

    def rungs(self, progress: Progress) -> tuple[tuple[Rung, ...], int]:
        """The rungs, and which is chosen: the first whose bound is within the tolerance, else the one nearest to it."""
        found: list[Rung] = []
        chosen: int | None = None
        for i, plant in enumerate(self.ladder):
            progress(i / len(self.ladder), plant.label)
            if chosen is not None:
                found.append(
                    Rung(plant.label, plant.nx, None, None, note="not tried: a cheaper one keeps the tolerance")
                )
                continue
            found.append(self._tried(plant))
            if self.shown(found[-1]):
                chosen = i
        if chosen is None:
            finite = [r.bound if r.bound is not None else float("inf") for r in found]
            chosen = int(np.argmin(finite)) if np.isfinite(finite).any() else len(found) - 1
        found[chosen] = dataclasses.replace(found[chosen], chosen=True)
        return tuple(found), chosen

    def shown(self, rung: Rung) -> bool:
        """Whether a rung is shown to keep the tolerance: by its bound, where physics is within its own range."""
        return rung.bound is not None and rung.bound <= self.tolerance and not self.outside and not self.failed

    def _tried(self, plant: Plant) -> Rung:
        error, outside, note = 0.0, "", ""
        for motions, physics in zip(self.played, self.physics):
            try:
                apart = _apart(motions, plant, CLIMB, physics)
                outside = outside or motions.outside_so_far(plant)
                if apart <= NEAR * self.tolerance:
                    apart = _apart(motions, plant, CONFIRMED, physics)
                error = max(error, apart)
            except PliantError as failure:
                error, note = float("inf"), f"{type(failure).__name__}: {failure}"
        if error == float("inf") and not note and not self.failed:
            note = "outputs that are no numbers"
        if outside and not note:
            note = "leaves the range of its kinematics"
        bound = error + self.uncertainty
        if any(known is not None and plant.label == known.physics.label for known in self.physics):
            error = bound  # of physics itself no more is known
        return Rung(plant.label, plant.nx, error, bound, note=note, outside=outside)

    def missing(self, met: bool, effects: Sequence[Effect]) -> tuple[str, ...]:
        """What a tolerance that is not met takes; of one that is met, what no model here has."""
        plant = self.ladder[-1]
        if met:
            return plant.unmodelled
        if self.failed or self.outside:
            return (self.failed or self.outside,)
        lacking = tuple(e.name for e in effects if not e.kept and e.change > 0.1 * self.tolerance)
        return (*lacking, *plant.unmodelled)


def _apart(motions: Motions, plant: Plant, rtol: float, physics: PhysicsMotion | None) -> float:
    """Largest difference of a rung's outputs from those of physics; infinite where these are not known, or no number
    is one: NaN would be no more than any tolerance to `max`.
    """
    own = motions.outputs(plant, rtol)
    found = float("inf") if physics is None else float(np.abs(own - physics.outputs).max())
    return found if np.isfinite(found) else float("inf")


def _rungs(plant: Plant, physics: Plant | None) -> tuple[Plant, ...]:
    """The ladder, the plant itself where it is on no rung, behind those of fewer states, and physics."""
    ladder: list[Plant] = list(plant.ladder())
    labels = {p.label for p in ladder}
    if plant.label not in labels:
        at = next((i for i, p in enumerate(ladder) if p.nx > plant.nx), len(ladder))
        ladder.insert(at, plant)
    if physics is not None and physics.label not in {p.label for p in ladder}:
        ladder.append(physics)
    return tuple(ladder)

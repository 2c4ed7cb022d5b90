"""The smallest model for a scene: climb from the cheapest to the first that keeps the tolerance against physics.

What physics gives (`physics_motion`: exact rotations, shear, as many shapes as matter) is known with a stated
uncertainty, and every rung's motion is compared with it. Rungs that agree with each other confirm nothing, as they may
lack the same effect. A rung's bound is its difference from physics and that uncertainty; a tolerance is met where the
bound keeps it. What even physics leaves out is named.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from pliant.controllers import Controller
from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, Trajectory
from pliant.plants.core.argument_gates import (
    as_tuple,
    require_count,
    require_function,
    require_instance,
    require_number,
)
from pliant.plants.files.html_tables import ChoiceTable
from pliant.studies.common.reference_motions import ClosedMotions, Motions, Progress, share, silent
from pliant.studies.physics import effects as worth
from pliant.studies.physics.effects import Effect

from .climb import Climb, Rung
from .integrators import in_lanes, integrators
from .speed_accuracy import Chart, Row
from .verdict_in_words import words

MOST_LANES = 1_000_000


@dataclass(frozen=True)
class Choice(ChoiceTable):
    """The chosen plant and why. `met` is False where no rung could be shown to keep the tolerance; where none has a
    result, none is chosen, and `plant` is the richest that can be played.
    """

    scene: str
    compare: tuple[str, ...]
    tolerance: float
    plant: Plant = field(repr=False)
    met: bool
    rungs: tuple[Rung, ...]
    effects: tuple[Effect, ...]
    physics: str  # what errors are measured against, and how it was found
    convergence: float  # its uncertainty
    beyond: tuple[str, ...]  # ranges that physics leaves beyond which no kinematics here hold: of strains, as a rule
    missing: tuple[str, ...]  # not met: the effects that it takes; met: what even physics leaves out
    integrator: Row | None  # the fastest within the tolerance, of the chosen plant
    batch: Row | None  # the fastest within it by the stepper, where lanes were asked for
    largest_step: Row | None  # the fixed-step method with the largest step within it
    text: str
    unit: str = "m"  # of the compared outputs, differences and tolerance
    motions: int = 1  # on which it is to be kept

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
        content["rungs"] = [asdict(rung) for rung in self.rungs]
        content["effects"] = [effect.to_json() for effect in self.effects]
        for name in ("integrator", "batch", "largest_step"):
            content[name] = None if content[name] is None else asdict(content[name])
        chosen = self.plant.label if any(rung.chosen for rung in self.rungs) else None
        return {"chosen": chosen, "states": self.plant.nx, **content}


def choose(
    scene: Scene,
    tolerance: float | None = None,
    *,
    measured: Chart | None = None,
    motions: Motions | Sequence[Any] | None = None,
    lanes: int = 1,
    progress: Progress | None = None,
) -> Choice:
    """The cheapest rung whose error bound is within `tolerance` [unit of scene.compare; None: the scene's].

    `motions`: which motions it is to keep it on, each None (the scene's open loop), a Trajectory, as of a closed loop,
    whose inputs are played at the control times, or a Controller, which is played in closed loop on every variant, as a
    machine that falls without it needs; None: the open loop alone. Also the fastest integrator and the
    largest fixed step that keep it on the first; `measured`, the scene's chart, which tries more methods, is asked for
    the fastest before. lanes: how many motions run at once, as in learning; beyond 1 `batch` is the fastest setting of
    the stepper for so many. Where no rung is shown to keep it, `met` is False, and `missing` says what is missing.
    ValueError for a tolerance not above 0.

    Example
    -------
    >>> found = choose(scene, 3e-3)
    >>> found.plant.label, found.met
    ('rigid', True)
    """
    require_instance("choose.scene", scene, Scene)
    tolerance = scene.tolerance if tolerance is None else tolerance
    tolerance = require_number("choose.tolerance", tolerance, "positive", scene.unit)
    if measured is not None:
        require_instance("choose.measured", measured, Chart)
    played = _motions(scene, motions)
    lanes = require_count("choose", "lanes", lanes, 1, MOST_LANES)
    if progress is not None:
        require_function("choose.progress", progress)
    told = progress or silent
    told(0.0, "physics")
    climb = Climb(played, tolerance)
    rungs, chosen = climb.rungs(share(progress, 0.3, 0.6))
    plant, met = climb.ladder[chosen], climb.shown(rungs[chosen])
    told(0.6, "effects")
    found_effects = worth.of(played[0], climb.physics[0], plant)
    fastest, largest, batch = None, None, None
    if met and climb.physics[0] is not None:
        told(0.7, "integrator")
        fastest, largest = integrators(played[0], climb.physics[0], plant, tolerance)
        if measured is not None:
            charted = measured.fastest(tolerance, plant.label)
            rows = [row for row in (fastest, charted) if row is not None]
            fastest = min(rows, key=lambda row: row.seconds or 0.0, default=None)
        if lanes > 1 and not isinstance(played[0], ClosedMotions):
            told(0.8, f"{lanes} lanes")
            batch = in_lanes(played[0], climb.physics[0], plant, tolerance, lanes)
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
        beyond=climb.beyond,
        missing=climb.missing(met, found_effects),
        integrator=fastest,
        batch=batch,
        largest_step=largest,
        text="",
        unit=scene.unit,
        motions=len(played),
    )
    told(1.0, "choice")
    return dataclasses.replace(found, text=words(found))


def _motions(scene: Scene, given: Any) -> list[Motions]:
    """The motions to keep the tolerance on."""
    if given is None:
        return [Motions(scene)]
    if isinstance(given, Motions):
        return [_of_this_scene("choose.motions", scene, given)]
    found = []
    for i, one in enumerate(as_tuple("choose.motions", given)):
        name = f"choose.motions[{i}]"
        if one is None:
            found.append(Motions(scene))
        elif isinstance(one, Motions):
            found.append(_of_this_scene(name, scene, one))
        elif isinstance(one, Controller):
            found.append(ClosedMotions(scene, one, name))
        else:
            found.append(Motions.with_inputs_of(scene, require_instance(name, one, Trajectory), name))
    if not found:
        raise ValueError("choose.motions = () must hold at least one motion")
    return found


def _of_this_scene(name: str, scene: Scene, motions: Motions) -> Motions:
    if motions.scene is not scene and motions.scene != scene:
        raise ValueError(f"{name} are motions of {motions.scene.name!r}, must be of the scene {scene.name!r} as it is")
    return motions

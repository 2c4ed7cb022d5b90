"""Rungs of a scene's ladder against physics, from the cheapest to the first that keeps the tolerance.

Rungs are the plant's ladder, the scene's own plant where its fields are on no rung of it, and physics itself.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.studies.common.reference_motions import Motions, Progress
from pliant.studies.physics.effects import Effect
from pliant.studies.physics.known_physics import PhysicsMotion
from pliant.studies.physics.physics_motion import physics_motion

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


class Climb:
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
        self.ladder = _rungs(played[0].scene.plant, richest, self._spared())
        self.unplayed = ""  # physics, where it cannot be played: a row with its reason, never the one returned
        if self.failed and richest is None:
            physics = played[0].scene.plant.physics()
            if physics.label not in {p.label for p in self.ladder}:
                self.ladder, self.unplayed = (*self.ladder, physics), physics.label
        self.outside = "; ".join(p.outside for p in known if p.outside)
        self.beyond = tuple(dict.fromkeys(words for p in known for words in p.beyond))

    def _spared(self) -> list[Plant]:
        """Rungs with as many shapes of each kind as physics' motions need."""
        found: list[Plant] = []
        for motions, known in zip(self.played, self.physics):
            if known is not None and known.motion is not None:
                within = self.tolerance
                found += known.physics.sparing(known.motion.trajectory(), motions.scene.compare, within)
        return found

    def rungs(self, progress: Progress) -> tuple[tuple[Rung, ...], int]:
        """The rungs, and which is returned: the first whose bound is within the tolerance, else the one nearest to it,
        where none has a result the richest. None without a result is called chosen.
        """
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
            last = len(found) - 1 - bool(self.unplayed)
            if not np.isfinite(finite).any():
                return tuple(found), last
            chosen = int(np.argmin(finite))
        found[chosen] = dataclasses.replace(found[chosen], chosen=True)
        return tuple(found), chosen

    def shown(self, rung: Rung) -> bool:
        """Whether a rung is shown to keep the tolerance: by its bound, where physics is within its own range."""
        return rung.bound is not None and rung.bound <= self.tolerance and not self.outside and not self.failed

    def _tried(self, plant: Plant) -> Rung:
        own = [p is not None and p.motion is not None and plant.label == p.physics.label for p in self.physics]
        if all(own):
            note = "physics itself: its error is what is known of it"
            return Rung(plant.label, plant.nx, self.uncertainty, self.uncertainty, note=note)
        if not any(self.physics):
            known = "cannot be played" if plant.label == self.unplayed else "is not known"
            note = f"not tried: physics {known}"
            return Rung(plant.label, plant.nx, float("inf"), float("inf"), note=note)
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
        told = {e.name for e in effects}
        unmodelled = tuple(name for name in self.ladder[-1].unmodelled if name not in told)
        if met:
            return unmodelled
        if self.failed or self.outside:
            return (self.failed or self.outside,)
        lacking = tuple(e.name for e in effects if not e.kept and e.change > 0.1 * self.tolerance)
        return (*lacking, *unmodelled)


def _apart(motions: Motions, plant: Plant, rtol: float, physics: PhysicsMotion | None) -> float:
    """Largest difference of a rung's outputs from those of physics; infinite where these are not known, or no number
    is one: NaN would be no more than any tolerance to `max`.
    """
    own = motions.outputs(plant, rtol)
    found = float("inf") if physics is None else float(np.abs(own - physics.outputs).max())
    return found if np.isfinite(found) else float("inf")


def _rungs(plant: Plant, physics: Plant | None, spared: Sequence[Plant] = ()) -> tuple[Plant, ...]:
    """The ladder, the plant itself and those with the shapes that a motion needs where they are on no rung of it, each
    behind those of fewer states, and physics.
    """
    ladder: list[Plant] = list(plant.ladder())
    for further in (plant, *spared):
        if further.label not in {p.label for p in ladder}:
            at = next((i for i, p in enumerate(ladder) if p.nx > further.nx), len(ladder))
            ladder.insert(at, further)
    if physics is not None and physics.label not in {p.label for p in ladder}:
        ladder.append(physics)
    return tuple(ladder)

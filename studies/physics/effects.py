"""What each effect of physics is worth on a scene's motion: how far the outputs move when it alone is left out.

Of physics where the chosen plant leaves it out: the motion without it is found as physics' own was, from that one, by
Newton's method; where that does not settle, it is simulated. Of the chosen plant where that keeps it: two simulations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions, in_time

from .known_physics import PhysicsMotion
from .physics_motion import outputs_of
from .quasi_linear import NotSettled

ROUGHLY = 1e-5  # rtol of a motion without an effect, where it is simulated
PATIENCE = 5.0  # [s] of processor time that such a motion may take
SHAPES = "shapes that it does not have"
SHARE = 0.02  # of what an effect is worth: to what that is known


@dataclass(frozen=True)
class Effect:
    """One effect of physics: the largest change of the compared outputs where it alone is left out [their unit]."""

    name: str
    change: float  # infinite where the motion without it is not found
    kept: bool  # in the chosen plant; else left out of it
    over_time: np.ndarray | None = field(default=None, repr=False, compare=False)  # (nt, n) the change, each output's

    def to_json(self) -> dict[str, Any]:
        """Without what it does over time."""
        return {"name": self.name, "change": self.change, "kept": self.kept}


def of(motions: Motions, physics: PhysicsMotion | None, chosen: Plant) -> tuple[Effect, ...]:
    """The effects that physics has, the largest first, and what is estimated of those that it has not; none where
    physics had to be simulated. Where the chosen plant does not bend, what refines bending is part of that.

    Those that the chosen plant leaves out and SHAPES, what more shapes of its own kinematics would change, sum up to
    its error, as far as effects add up.
    """
    if physics is None or physics.motion is None:  # each would be another long simulation
        return ()
    has, known = chosen.effects, _Known(motions, physics, chosen)
    names = {name: has.get(name, False) for name, modelled in physics.physics.effects.items() if modelled}
    if not names.get("bending", True):
        names = {"bending": False}  # all others are of what bends
    found = [_effect(known, name, kept) for name, kept in names.items()]
    if physics.physics != chosen and names.get("bending", True):
        found.append(_shapes(known, [name for name, kept in names.items() if not kept]))
    found += [Effect(name, change, False) for name, change in physics.estimated.items()]
    return tuple(sorted(found, key=lambda e: -e.change))


class _Known:
    """Physics on a motion, and the outputs (nt, n) of what is near to it and to the chosen plant, each found once."""

    def __init__(self, motions: Motions, physics: PhysicsMotion, chosen: Plant) -> None:
        self.motions, self.physics, self.chosen = motions, physics, chosen
        self._lacking: dict[Plant, np.ndarray] = {}

    @cached_property
    def roughly(self) -> np.ndarray:
        """Of the chosen plant at ROUGHLY."""
        return self.played(self.chosen)

    def played(self, plant: Plant) -> np.ndarray:
        """Of a simulation; TooLong after PATIENCE."""
        return self.motions.outputs(plant, ROUGHLY, progress=in_time(plant, processor_time() + PATIENCE))

    def without(self, names: Sequence[str]) -> np.ndarray:
        """Of physics without some effects; PliantError where it has no motion."""
        lacking = self.physics.physics
        for name in names:
            lacking = lacking.without(name)
        if lacking not in self._lacking:
            try:
                self._lacking[lacking] = outputs_of(self.motions, lacking, self.physics, SHARE)
            except NotSettled:
                self._lacking[lacking] = self.played(lacking)
        return self._lacking[lacking]


def _effect(known: _Known, name: str, kept: bool) -> Effect:
    try:
        if kept and known.chosen != known.physics.physics:
            apart = known.roughly - known.played(known.chosen.without(name))
        else:
            apart = known.physics.outputs - known.without((name,))
    except PliantError:  # it has no motion, or none in time
        return Effect(name, float("inf"), kept)
    return Effect(name, float(np.abs(apart).max()), kept, apart)


def _shapes(known: _Known, lacking: Sequence[str]) -> Effect:
    try:
        apart = known.without(lacking) - known.roughly
    except PliantError:
        return Effect(SHAPES, float("inf"), False)
    return Effect(SHAPES, float(np.abs(apart).max()), False, apart)

"""What each effect of physics is worth on a scene's motion: how far the outputs move when it alone is left out.

The motion without it is found as physics' own was, from that one, by Newton's method; where that does not settle, as
with an effect that changes everything, it is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.studies.common.reference_motions import Motions

from .physics_motion import PhysicsMotion, outputs_of
from .quasi_linear import NotSettled

SIMULATED = 1e-7  # rtol of a motion without an effect, where it is simulated


@dataclass(frozen=True)
class Effect:
    """One effect of physics: the largest change of the compared outputs where it alone is left out [their unit]."""

    name: str
    change: float  # infinite where the motion without it is not found
    kept: bool  # in the chosen plant; else left out of it


def of(motions: Motions, physics: PhysicsMotion | None, chosen: Plant) -> tuple[Effect, ...]:
    """The effects that physics has, the largest first; none where physics had to be simulated."""
    if physics is None or physics.motion is None:  # each would be another long simulation
        return ()
    has = chosen.effects
    found = [Effect(name, _worth(motions, physics, name), has.get(name, False)) for name in physics.physics.effects]
    return tuple(sorted(found, key=lambda e: -e.change))


def _worth(motions: Motions, physics: PhysicsMotion, name: str) -> float:
    lacking = physics.physics.without(name)
    try:
        try:
            found = outputs_of(motions, lacking, physics)
        except NotSettled:
            found = motions.outputs(lacking, SIMULATED)
    except PliantError:  # it has no motion at all
        return float("inf")
    return float(np.abs(found - physics.outputs).max())

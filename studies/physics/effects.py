"""What each effect of physics is worth on a scene's motion: how far the outputs move when it alone is left out.

Of physics where the chosen plant leaves it out: the motion without it is found as physics' own was, from that one, by
Newton's method; where that does not settle, it is simulated. Of the chosen plant where that keeps it: two simulations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.studies.common.reference_motions import Motions

from .physics_motion import PhysicsMotion, outputs_of
from .quasi_linear import NotSettled

ROUGHLY = 1e-5  # rtol of a motion without an effect, where it is simulated
SHARE = 0.02  # of what an effect is worth: to what that is known


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
    has, found = chosen.effects, list[Effect]()
    for name in physics.physics.effects:
        kept = has.get(name, False)
        try:
            change = _to_chosen(motions, chosen, name) if kept else _to_physics(motions, physics, name)
        except PliantError:  # it has no motion at all
            change = float("inf")
        found.append(Effect(name, change, kept))
    return tuple(sorted(found, key=lambda e: -e.change))


def _to_chosen(motions: Motions, chosen: Plant, name: str) -> float:
    return _apart(motions.outputs(chosen.without(name), ROUGHLY), motions.outputs(chosen, ROUGHLY))


def _to_physics(motions: Motions, physics: PhysicsMotion, name: str) -> float:
    lacking = physics.physics.without(name)
    try:
        found = outputs_of(motions, lacking, physics, SHARE)
    except NotSettled:
        found = motions.outputs(lacking, ROUGHLY)
    return _apart(found, physics.outputs)


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.abs(one - other).max())

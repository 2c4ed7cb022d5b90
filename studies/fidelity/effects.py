"""What each effect of physics is worth on a scene's motion: how far the outputs move when it alone is left out.

To first order, without another motion: leaving an effect out changes the rates along physics' motion by
f_without(x) - f(x), physics' linear model carries that change, and what the outputs change by themselves is added. An
effect without which the model has other states, as bending or shear, has its motion found as physics' own was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.plants import Plant, PliantError
from pliant.plants.core.signals import names
from pliant.studies.common.reference_motions import Motions

from .physics_motion import PhysicsMotion, outputs_of


@dataclass(frozen=True)
class Effect:
    """One effect of physics: the largest change of the compared outputs where it alone is left out [their unit]."""

    name: str
    change: float  # infinite where the motion without it is not found
    kept: bool  # in the chosen plant; else left out of it


def of(motions: Motions, physics: PhysicsMotion | None, chosen: Plant) -> tuple[Effect, ...]:
    """The effects that physics has, the largest first; none where physics had to be simulated."""
    if physics is None or physics.motion is None:  # its linear model is not known, and another motion costs too much
        return ()
    has = chosen.effects
    found = [Effect(name, _worth(motions, physics, name), has.get(name, False)) for name in physics.physics.effects]
    return tuple(sorted(found, key=lambda e: -e.change))


def _worth(motions: Motions, physics: PhysicsMotion, name: str) -> float:
    try:
        lacking = physics.physics.without(name)
        assert physics.motion is not None
        same = names(lacking.states) == names(physics.physics.states)
        if same and np.allclose(lacking.embedding(physics.physics), np.eye(lacking.nx), atol=1e-9):
            return float(np.abs(physics.motion.without(lacking)).max())
        return float(np.abs(outputs_of(motions, lacking, physics) - physics.outputs).max())
    except PliantError:
        return float("inf")

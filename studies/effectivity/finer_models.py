"""What is true on a random scene: a model that is on no ladder and richer than what `choose` calls physics.

Exact rotations with shear and extension, in more polynomials than physics takes, which converge fastest (of two links,
five natural modes each were 0.1 mm off where five and six polynomials differed by 4 nm); of a spacecraft panels whose
data hold more modes; of a beam polynomials where physics takes other shapes. Arms whose tolerance is so tight that
physics takes as many are played by another integrator alone. Two sizes are simulated at rtol 1e-10 by CVODES, which
`choose` does not use, and how far they are apart is how well the truth is known.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.envs.machines.spacecraft_parts import WIDTH
from pliant.plants import Plant
from pliant.plants.modal_data.modal_data import ModalData
from pliant.studies.common.reference_motions import TIGHT, Motions

from .random_scenes import Drawn

Array = np.ndarray
SIZES = {  # of the two, by the kind of the scene
    "single-link slew": (5, 6),
    "spin-up": (5, 6),
    "two-link reach": (4, 5),
    "cantilever drop": (9, 10),
    "spacecraft slew": (5, 6),
}
EXACT = {"kinematics": "strain", "basis": "polynomial"}
ARM = {**EXACT, "theory": "timoshenko", "extensible": True}


@dataclass(frozen=True, eq=False)
class Truth:
    """The compared outputs (nt, n) of the finer model, and how far the smaller one's are from them [their unit]."""

    outputs: Array
    uncertainty: float
    model: str


def truth(drawn: Drawn, motions: Motions) -> Truth:
    """PliantError where the finer models cannot be simulated."""
    coarse, fine = finer_models(drawn)
    rough, found = (_played(motions, plant) for plant in (coarse, fine))
    return Truth(found, float(np.abs(rough - found).max()), fine.label)


def _played(motions: Motions, plant: Plant) -> Array:
    return motions.compared(motions.run(plant, method="cvodes", rtol=TIGHT, atol=TIGHT / 100))


def finer_models(drawn: Drawn) -> tuple[Plant, ...]:
    """The scene's machine in two sizes, the finer last.

    Example
    -------
    >>> [plant.label for plant in finer_models(random_scene(0))]
    """
    return tuple(_finer(drawn, n) for n in SIZES[drawn.kind])


def _finer(drawn: Drawn, n: int) -> Plant:
    plant: Any = drawn.scene.plant
    if drawn.kind == "spacecraft slew":
        assert drawn.line is not None
        panel = ModalData.panel(drawn.line, WIDTH, (n, 0))
        bodies = tuple(dataclasses.replace(a, body=panel, modes=None) for a in plant.appendages)
        changes: dict[str, Any] = {"kinematics": "stiffened", "appendages": bodies}
    elif drawn.kind == "cantilever drop":
        changes = {**EXACT, "modes": n, "segments": 1, "points": None, "stretches": n - 6, "shears": n - 6}
        changes |= {"extensible": True, "theory": "timoshenko"}
    elif drawn.kind == "two-link reach":
        changes = {**ARM, "modes": (n, n), "reduction": "full", "tip_slope": True}
    else:
        changes = {**ARM, "modes": n, "frame": "clamped"}
    found: Plant = dataclasses.replace(plant, **changes)
    return found

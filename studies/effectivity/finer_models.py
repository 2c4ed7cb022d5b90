"""What is true on a random scene: a model that is on no ladder and richer than what `choose` calls physics.

Exact rotations with shear, in more polynomials than physics takes, which converge fastest (of two links five natural
modes each were 0.1 mm off where five and six polynomials differed by 4 nm); of a spacecraft panels whose data hold more
modes; of a beam polynomials where physics takes other shapes. Arms whose tolerance is so tight that physics takes as
many are played by another integrator alone. Two sizes are simulated at rtol 1e-10 by CVODES, which `choose` does not
use, and how far they are apart is how well the truth is known.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.envs.scenes.spacecraft_parts import WIDTH
from pliant.plants import FlexibleSpacecraft, LargeDeflectionBeam, Plant, SingleLinkArm, TwoLinkArm
from pliant.plants.modal_data.modal_data import ModalData
from pliant.studies.common.reference_motions import TIGHT, Motions

from .random_scenes import Drawn

Array = np.ndarray


SIZES: dict[Any, tuple[int, int]] = {
    SingleLinkArm: (5, 6),
    TwoLinkArm: (4, 5),
    LargeDeflectionBeam: (9, 10),
    FlexibleSpacecraft: (5, 6),
}


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
    plant: Any = drawn.scene.plant
    kind: Any = type(plant)
    sizes = SIZES[kind]
    if isinstance(plant, FlexibleSpacecraft):
        assert drawn.line is not None
        return tuple(_craft(plant, ModalData.panel(drawn.line, WIDTH, (n, 0))) for n in sizes)
    exact: dict[str, Any] = {"kinematics": "strain"}
    if isinstance(plant, LargeDeflectionBeam):
        exact |= {"segments": 1, "points": None, "basis": "polynomial"}
        return tuple(dataclasses.replace(plant, modes=n, **exact) for n in sizes)
    exact |= {"theory": "timoshenko", "basis": "polynomial"}
    if isinstance(plant, TwoLinkArm):
        exact |= {"reduction": "full", "tip_slope": True}
        return tuple(dataclasses.replace(plant, modes=(n, n), **exact) for n in sizes)
    return tuple(dataclasses.replace(plant, modes=n, frame="clamped", **exact) for n in sizes)


def _craft(plant: FlexibleSpacecraft, panel: ModalData) -> FlexibleSpacecraft:
    bodies = tuple(dataclasses.replace(a, body=panel, modes=None) for a in plant.appendages)
    return dataclasses.replace(plant, kinematics="stiffened", appendages=bodies)

"""The craft that attitude papers quote: inertia, coupling matrix, frequencies and damping of its four modes.

S. Di Gennaro, "Output stabilization of flexible spacecraft with active vibration suppression", IEEE Transactions on
Aerospace and Electronic Systems 39 (3), 2003: J [kg m^2], delta [kg^0.5 m], omega [rad/s], zeta, as later papers quote
them. The paper gives no masses: without translation, and with the factors of translation zero, they do not matter.
"""

import dataclasses

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import FlexibleSpacecraft
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.hub import Hub

J = np.array([[350.0, 3.0, 4.0], [3.0, 270.0, 10.0], [4.0, 10.0, 190.0]])
DELTA = np.array(
    [
        [6.45637, 1.27814, 2.15629],
        [-1.25619, 0.91756, -1.67264],
        [1.11687, 2.48901, -0.83674],
        [1.23637, -2.6581, -1.12503],
    ]
)
FREQUENCIES, DAMPING = (0.7681, 1.1038, 1.8733, 2.5496), (0.0056, 0.0086, 0.013, 0.025)
ATTITUDE, RATES = tuple(f"attitude_{c}" for c in "xyz"), tuple(f"body_rate_{c}" for c in "xyz")


def craft(kinematics: str = "linear") -> FlexibleSpacecraft:
    """Half of the inertia is the hub's, half the body's that has the modes: at rest only the sum is felt."""
    body = ModalData.from_participation(100.0, (0, 0, 0), J / 2, FREQUENCIES, DAMPING, None, DELTA)
    parts = {"hub": Hub(mass=400.0, inertia=J / 2), "appendages": (Appendage(position=(0.0, 0.0, 0.0), body=body),)}
    return FlexibleSpacecraft(**parts, kinematics=kinematics, translation=False)


def scene(duration: float = 60.0, dt: float = 0.25) -> Scene:
    """Hold its attitude after 5 degrees about x."""
    half = np.deg2rad(5.0) / 2
    return Scene(
        name="data-sheet-craft",
        about="a craft known by its participation factors",
        plant=craft(),
        start=(("quaternion_0", float(np.cos(half))), ("quaternion_1", float(-np.sin(half)))),
        goal=(("quaternion_0", 1.0),),
        start_at_rest=False,
        duration=duration,
        move_time=duration / 2,
        dt=dt,
        substeps=2,
        limits=(20.0, 20.0, 20.0),
        weights=tuple((n, 1.0) for n in ATTITUDE) + tuple((n, 10.0) for n in RATES),
        effort=tuple((f"torque_{c}", 1e-3) for c in "xyz"),
        observe=(*ATTITUDE, *RATES),
        compare=("attitude_x",),
    )


def pointing(bandwidth: float, dt: float | None = 0.25, damping: float = 1.0):
    """A proportional-derivative law of `bandwidth` [rad/s] on the rigid craft."""
    from pliant.controllers import Feedback

    K = np.hstack([bandwidth**2 * J, 2 * damping * bandwidth * J])
    return Feedback(K, ATTITUDE + RATES, limits=(-20.0, 20.0), dt=dt)


def shifted(plant: FlexibleSpacecraft, factor: float) -> FlexibleSpacecraft:
    """All frequencies of its modes times `factor`."""
    (body,) = plant.appendages
    return dataclasses.replace(plant, appendages=(dataclasses.replace(body, stiffness_factor=factor**2),))

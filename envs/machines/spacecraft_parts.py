"""What the spacecraft of the scenes are made of: two solar panels on a hub, four wheels, turns by the names of states.

Two 6 m x 2 m panels of 12 kg each, whose first bending frequency is 0.15 Hz when clamped and whose modes have 0.5 % of
the critical damping. The numbers are chosen here, of the size of what a 500 kg satellite carries.
"""

from __future__ import annotations

import numpy as np

from pliant.plants import Beam
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
from pliant.plants.spacecraft_parts.environment import Surface
from pliant.plants.spacecraft_parts.hub import Wheel

LINE = Beam(length=6.0, area=1e-3, I_y=9.3e-8, I_z=1e-5, J=1e-6, density=1000.0, E=1e9, G=4e8)  # half a panel: 6 kg
WIDTH, ROOT, DAMPING = 2.0, 1.0, 0.005  # [m], [m] off the hub's centre, ratio of every mode
KNOWN = 4  # bending modes that the data of a panel hold
AXES = "xyz"
Rows = tuple[tuple[float, float, float], ...]
# Columns are the panel's axes in hub axes: its x along the boom, its z normal to it
FLAT: tuple[Rows, Rows] = (
    ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
)
UPRIGHT: tuple[Rows, Rows] = (
    ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
    ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
)
ALONG_Y: tuple[Rows, Rows] = (
    ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
)
# Four wheels along the space diagonals, three of which still turn the craft about every axis. Typical of wheels of this
# size, chosen here: torque up to 0.2 N m and 6 N m s at 600 rad/s (5700 turns a minute)
WHEEL_TORQUE, WHEEL_MOMENTUM, WHEEL_INERTIA = 0.2, 6.0, 0.01  # [N m], [N m s], [kg m^2]
SLANT = float(np.sqrt(1 / 3))
PYRAMID = tuple(
    Wheel(axis=(a * SLANT, b * SLANT, SLANT), inertia=WHEEL_INERTIA) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
)


def panels(
    mounts: tuple[Rows, Rows], hinge: Hinge | None = None, surface: Surface | None = None, *, known: int = KNOWN
) -> tuple[Appendage, ...]:
    """Two panels that leave the hub along the first columns of `mounts`; one of the `known` bending modes is in use."""
    data = ModalData.panel(LINE, WIDTH, (known, 0))
    return tuple(
        Appendage(
            position=tuple(ROOT * row[0] for row in mount),
            orientation=mount,
            body=data,
            modes=1,
            damping=DAMPING,
            hinge=hinge or Hinge(),
            surface=surface,
        )
        for mount in mounts
    )


def turned(angle_deg: float, axis: str) -> tuple[tuple[str, float], ...]:
    """The quaternion of a turn about an axis, by the names of states."""
    half, k = np.deg2rad(angle_deg) / 2, AXES.index(axis)
    parts = [np.cos(half), *(np.sin(half) * float(i == k) for i in range(3))]
    return tuple((f"quaternion_{i}", float(value)) for i, value in enumerate(parts))

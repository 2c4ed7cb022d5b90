"""A slew from rest to rest about one axis fixed in the body, by inverse dynamics of the rigid spacecraft.

Without loads the rigid equations are J d(omega)/dt + omega x (J omega + h) = torque at any attitude, h of the wheels.
Without wheels the inputs are a share of the angle's acceleration and one of its rate squared. Wheels that start at rest
keep J omega + h = 0, the total momentum: they take what the hub has, nothing precesses, and beside the share of the
acceleration there is only their bearings' friction, a share of the rate. More wheels than three share the torque so
that the sum of its squares is least.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant.plants.core.quaternions import product
from pliant.plants.integration.inverse_dynamics import rest_to_rest_ends
from pliant.plants.integration.minimum_jerk import profile_of
from pliant.plants.spacecraft_parts.environment import Environment

from .declaration import SpacecraftDeclaration

Array = np.ndarray
TURNED = 1e-9  # share of a turn that inputs may lack


def slew(
    craft: SpacecraftDeclaration, begin: Array, end: Array, time: float, profile: str = "minimum-jerk"
) -> Callable[[float], Array]:
    """u(t) (nu,) from the attitude of `begin` (nx,) to that of `end` in `time` [s], at rest at both, hinges as at
    `begin`. ValueError with loads, with wheels that do not rest at `begin`, and where no input turns it about the axis.
    """
    if craft.environment != Environment():
        raise ValueError("a spacecraft without loads, to turn about one axis")
    motion = profile_of("rest_to_rest", profile)
    x, last, time = rest_to_rest_ends(craft, begin, end, time)
    at = craft.layout
    turn = _rotation_vector(product(x[at.quaternion] * [1.0, -1.0, -1.0, -1.0], last[at.quaternion]))  # in body axes
    if np.any(x[at.wheels]):
        raise ValueError(f"wheels at rest at the start, not with {x[at.wheels]} N m s, to turn about one axis")
    B = craft.jacobians(x)[1][at.omega]
    speeding = np.linalg.lstsq(B, turn, rcond=None)[0]
    if np.abs(B @ speeding - turn).max() > TURNED * np.abs(turn).max():
        raise ValueError(f"inputs that turn it about {turn / np.linalg.norm(turn)}, which wheels or thrusters do not")
    wheels = len(craft.hub.wheels)
    x[at.omega], x[at.wheels] = turn, -speeding[:wheels]
    rubbed = np.zeros(craft.nu)  # as the wheels' friction acts on the hub at d(angle)/dt = turn
    for k, wheel in enumerate(craft.hub.wheels):
        rubbed[k] = wheel.friction * (x[at.wheels][k] / wheel.inertia - np.dot(wheel.axis, turn))
    lacking = craft.dynamics(x, -rubbed)[at.omega]
    turning = np.linalg.lstsq(B, -lacking, rcond=None)[0]

    def torque(t: float) -> Array:
        _, ds, dds = motion(t / time)
        return speeding * (dds / time**2) - rubbed * (ds / time) + turning * (ds / time) ** 2

    return torque


def _rotation_vector(q: Array) -> Array:
    """The shorter turn (3,) [rad] of a unit quaternion (4,)."""
    q = -q if q[0] < 0 else q
    size = np.linalg.norm(q[1:])
    return 2 * np.arctan2(size, q[0]) * q[1:] / size if size > 0 else np.zeros(3)

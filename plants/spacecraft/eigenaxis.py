"""A slew from rest to rest about one axis fixed in the body, by inverse dynamics of the rigid spacecraft.

Without loads and wheels the rigid equations are J d(omega)/dt + omega x J omega = torque at any attitude, so that the
inputs are a share of the angle's acceleration and one of its rate squared.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant.plants.core.minimum_jerk import minimum_jerk
from pliant.plants.core.quaternions import product
from pliant.plants.spacecraft_parts.environment import Environment

from .declaration import SpacecraftDeclaration

Array = np.ndarray


def slew(craft: SpacecraftDeclaration, begin: Array, end: Array, time: float) -> Callable[[float], Array]:
    """u(t) (nu,) from the attitude of `begin` (nx,) to that of `end` in `time` [s], at rest at both, hinges as at
    `begin`. ValueError with loads or wheels.
    """
    if craft.environment != Environment() or craft.hub.wheels:
        raise ValueError("a spacecraft without loads and wheels, to turn about one axis")
    at, x = craft.layout, np.array(begin, dtype=float)
    first, last = x[at.quaternion], np.asarray(end, dtype=float)[at.quaternion]
    turn = _rotation_vector(product(first * [1.0, -1.0, -1.0, -1.0], last))  # in body axes
    x[at.omega] = turn
    B = craft.jacobians(x)[1][at.omega]
    speeding, turning = (np.linalg.lstsq(B, v, rcond=None)[0] for v in (turn, -craft.dynamics(x)[at.omega]))

    def torque(t: float) -> Array:
        _, ds, dds = minimum_jerk(t / time)
        return speeding * (dds / time**2) + turning * (ds / time) ** 2

    return torque


def _rotation_vector(q: Array) -> Array:
    """The shorter turn (3,) [rad] of a unit quaternion (4,)."""
    q = -q if q[0] < 0 else q
    size = np.linalg.norm(q[1:])
    return 2 * np.arctan2(size, q[0]) * q[1:] / size if size > 0 else np.zeros(3)

"""The slider-crank with a rigid rod: closed kinematics, their inverse, and the dead centres where that fails.

sin phi2 = -lambda sin phi1, x = r cos phi1 + l cos phi2, lambda = r/l < 1; phi1, phi2 from the slider's line +x.
Dead centres  phi1 a multiple of pi: the lever dx/dphi1 = -r sin(phi1 - phi2)/cos phi2 vanishes
Source        "Elastodynamic Analysis of a Mechanism with Flexible Links", Eqs (23), (24). Departures: lambda is
              printed inverted, and (24) is a series; exact here
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.parameters import quantity, validate

DEAD = 1e-9  # |dx/dphi1| / r below which a crank angle is a dead centre


class RigidMotion(NamedTuple):
    """Exact motion of the rigid mechanism at constant crank speed; arrays of the angles' shape."""

    rod_angle: np.ndarray  # [rad]
    rod_rate: np.ndarray  # [rad/s]
    rod_acceleration: np.ndarray  # [rad/s^2]
    slider_x: np.ndarray  # [m]
    slider_speed: np.ndarray  # [m/s]
    slider_acceleration: np.ndarray  # [m/s^2]


@dataclass(frozen=True)
class RigidSliderCrank:
    """A crank that can turn fully: shorter than its rod."""

    crank_radius: float = quantity("m", "positive")
    rod_length: float = quantity("m", "positive")

    def __post_init__(self) -> None:
        validate(self)
        check_ratio("RigidSliderCrank", "rod_length", self.crank_radius, self.rod_length)

    def motion(self, angle: Any, speed: float) -> RigidMotion:
        """The motion at crank angles (...,) [rad] and a constant crank speed [rad/s]."""
        phi = np.asarray(angle, dtype=float)
        sine, cosine = np.sin(phi), np.cos(phi)
        r, length = self.crank_radius, self.rod_length
        lam = r / length
        x, y = np.sqrt(1 - (lam * sine) ** 2), -lam * sine  # the rod's direction
        rate = -lam * speed * cosine / x
        turn = lam * speed**2 * sine * (1 - lam**2) / x**3
        return RigidMotion(
            np.arcsin(y),
            rate,
            turn,
            r * cosine + length * x,
            -r * speed * sine - length * y * rate,
            -r * speed**2 * cosine - length * (x * rate**2 + y * turn),
        )

    def lever(self, angle: float) -> float:
        """dx/dphi1 [m/rad]: slider speed over crank speed, and crank torque over slider force."""
        return float(self.motion(angle, 1.0).slider_speed)

    def held_force(self, angle: float, torque: float) -> float:
        """Force on the slider along -x [N] that a crank torque [N m] holds at rest, without gravity.

        ValueError at a dead centre, where no torque balances any force.
        """
        return torque / self._nonzero_lever(angle, "the force that a torque holds")

    def crank_rate(self, angle: float, slider_speed: float) -> float:
        """Crank speed [rad/s] at which the slider moves at slider_speed [m/s]; ValueError at a dead centre."""
        return slider_speed / self._nonzero_lever(angle, "the crank's speed")

    def _nonzero_lever(self, angle: float, what: str) -> float:
        lever = self.lever(angle)
        if not abs(lever) >= DEAD * self.crank_radius:
            raise ValueError(
                f"angle = {angle!r} must be finite and no dead centre (a multiple of pi) [rad]: the lever dx/dphi1 = "
                f"{lever:.2g} m/rad vanishes there and {what} cannot be found from it"
            )
        return lever

    def crank_angle_at(self, slider_x: float, upper: bool = True) -> float:
        """Crank angle [rad] in [0, pi], or in [-pi, 0] if not `upper`, with the slider at slider_x [m].

        ValueError where the slider cannot be. Near a dead centre an error of x moves the angle by its root.
        """
        r, length = self.crank_radius, self.rod_length
        low, high = length - r, length + r
        if not low <= slider_x <= high:
            raise ValueError(f"slider_x = {slider_x!r} must be within [{low:.9g}, {high:.9g}] [m]")
        cosine = (slider_x**2 + r**2 - length**2) / (2 * r * slider_x)
        return math.copysign(math.acos(min(1.0, max(-1.0, cosine))), 1 if upper else -1)


def check_ratio(owner: str, rod: str, radius: float, length: float) -> None:
    """Raise ValueError unless the crank is shorter than the rod."""
    if radius >= length:
        raise ValueError(
            f"{owner}.crank_radius = {radius!r} must be > 0 and < {rod} = {length!r} [m]: a longer crank cannot "
            "turn fully, the rod's angle has no real value"
        )

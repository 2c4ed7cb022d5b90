"""Loads from outside: gravity in orbit, sunlight, residual magnetic and constant torques. Each is off unless given.

Orbit axes   x along the velocity, y against the orbit normal, z to the centre of attraction (local vertical, local
horizontal)
Valid        circular reference orbit; gravity exact at the hub and linear across the spacecraft; no eclipse, no
             shadow of one body on another
Source       "Equations of Motion of Flexible Spacecraft", Eqs (19)-(24); the sign of the 3 (X.d)(X.phi) term in
             (23) corrected. Light pressure: Wertz, "Spacecraft Attitude Determination and Control" (1978), Eq (17-18).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from pliant.plants.core.argument_gates import require_instance, unit_vector
from pliant.plants.core.parameters import flag, is_symbolic, quantity, validate
from pliant.plants.core.quaternions import about

EARTH_RADIUS = 6.778e6  # [m], about 400 km up
UNIT_VECTOR = "is a part of a unit vector"
SOLAR_PRESSURE = 4.56e-6  # [N/m^2] at 1 au: 1367 W/m^2 over the speed of light


@dataclass(frozen=True, kw_only=True)
class Orbit:
    """A circular orbit whose axes are the reference axes: attitude and position are relative to them.

    gravity=False keeps the axes turning but takes the differences of gravity across the spacecraft away.
    """

    rate: Any = quantity("rad/s", "positive")
    radius: Any = quantity("m", "positive", EARTH_RADIUS)
    gravity: bool = flag(True)

    def __post_init__(self) -> None:
        validate(self)

    @property
    def turning(self) -> ca.SX:
        """Angular velocity of the orbit axes in themselves (3,) [rad/s]."""
        return ca.vertcat(0, -self.rate, 0)

    def pull(self, position: ca.SX) -> tuple[ca.SX, ca.SX]:
        """At `position` (3,) relative to the orbit: gravity (3,) [m/s^2] less that on the orbit, and its gradient
        (3, 3).
        """
        if not self.gravity:
            return ca.SX.zeros(3), ca.SX(3, 3)
        X = position - ca.vertcat(0, 0, self.radius)
        square = ca.dot(X, X)
        scale = self.rate**2 * (self.radius**2 / square) ** 1.5
        gradient = scale * (3 * X @ X.T / square - ca.SX.eye(3))
        return -scale * X - self.rate**2 * ca.vertcat(0, 0, self.radius), gradient


@dataclass(frozen=True, kw_only=True)
class Sun:
    """Sunlight from `direction`: a unit vector to the sun in reference axes at t = 0, fixed in space."""

    direction: Any = quantity("1", "finite", shape=(3,), fixed=UNIT_VECTOR)
    pressure: Any = quantity("N/m^2", "nonnegative", SOLAR_PRESSURE)

    def __post_init__(self) -> None:
        validate(self)
        unit_vector("Sun.direction", self.direction)

    def at(self, t: ca.SX, orbit: Orbit | None) -> ca.SX:
        """Direction (3,) at time t in reference axes, which turn where there is an orbit."""
        s = ca.vertcat(*self.direction)
        return s if orbit is None else about((0.0, 1.0, 0.0), orbit.rate * t) @ s


@dataclass(frozen=True, kw_only=True)
class Surface:
    """A flat surface: area, outward normal, reflected shares, centre (on the hub only). `both`: it has two bright
    sides.
    """

    area: Any = quantity("m^2", "nonnegative")
    normal: Any = quantity("1", "finite", shape=(3,), fixed=UNIT_VECTOR)
    specular: Any = quantity("1", "nonnegative", 0.0)
    diffuse: Any = quantity("1", "nonnegative", 0.0)
    centre: Any = quantity("m", "finite", (0.0, 0.0, 0.0), shape=(3,))
    both: bool = flag(False)

    def __post_init__(self) -> None:
        validate(self)
        unit_vector("Surface.normal", self.normal)
        if not is_symbolic(self.specular + self.diffuse) and self.specular + self.diffuse > 1:
            raise ValueError(f"Surface.specular + diffuse = {self.specular + self.diffuse} must be <= 1")

    def force(self, sun: ca.SX, pressure: Any) -> ca.SX:
        """Force of light (3,) [N] for the sun's direction (3,), both in the surface's axes; pressure [N/m^2]."""
        n = ca.vertcat(*self.normal)
        c = ca.dot(sun, n)
        lit = ca.fabs(c) if self.both else ca.fmax(c, 0)
        along = c if self.both else lit  # lit, against the normal where the back is lit
        push = (1 - self.specular) * lit * sun + 2 * (self.specular * lit + self.diffuse / 3) * along * n
        return -pressure * self.area * push


@dataclass(frozen=True, kw_only=True)
class Environment:
    """What acts from outside. The magnetic field is constant in reference axes, dipole and torque in hub axes."""

    orbit: Orbit | None = None
    sun: Sun | None = None
    dipole: Any = quantity("A m^2", "finite", (0.0, 0.0, 0.0), shape=(3,))
    magnetic_field: Any = quantity("T", "finite", (0.0, 0.0, 0.0), shape=(3,))
    torque: Any = quantity("N m", "finite", (0.0, 0.0, 0.0), shape=(3,))

    def __post_init__(self) -> None:
        validate(self)
        if self.orbit is not None:
            require_instance("Environment.orbit", self.orbit, Orbit)
        if self.sun is not None:
            require_instance("Environment.sun", self.sun, Sun)

    def residual_torque(self, R: ca.SX) -> ca.SX:
        """Torque on the hub (3,) [N m] in hub axes at the attitude R."""
        return ca.cross(ca.vertcat(*self.dipole), R.T @ ca.vertcat(*self.magnetic_field)) + ca.vertcat(*self.torque)

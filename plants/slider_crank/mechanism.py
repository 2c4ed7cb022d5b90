"""The mechanism of a slider-crank with an elastic rod: its parameters, its signals and the geometry of its loop."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import casadi as ca
import numpy as np

from pliant.plants.beams.pinned_rod import KINDS, MOST_ELEMENTS, PinnedRod, rod_shapes
from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.parameters import is_symbolic, part, quantity, require_choice, require_count, validate
from pliant.plants.core.signals import Sensed, Signal
from pliant.plants.dynamics.arguments import line_points, one_state
from pliant.plants.dynamics.lagrangian import LagrangianPlant

from .rigid_kinematics import RigidSliderCrank, check_ratio

KINEMATICS = ("rigid", "linear", "stiffened")
MOST_MODES = 40


@dataclass(frozen=True, kw_only=True)
class SliderCrankMechanism(LagrangianPlant):
    """Crank, rod and slider; `SliderCrank` adds their energies, loads and reactions."""

    crank_radius: float = quantity("m", "positive")
    rod: Beam = part(Beam)
    slider_mass: float = quantity("kg", "nonnegative")
    force: float = quantity("N", "finite", 0.0)  # on the slider along -x, towards the crank
    crank_speed: float | None = None  # [rad/s]; None: the crank is free under the input torque
    crank_inertia: float = quantity("kg m^2", "nonnegative", 0.0)  # about the shaft
    crank_friction: float = quantity("N m s/rad", "nonnegative", 0.0)
    slider_friction: float = quantity("N s/m", "nonnegative", 0.0)
    dry_friction: float = quantity("N", "nonnegative", 0.0)  # of the slider, constant, smoothed over DRY_SPEED
    gravity: float = quantity("m/s^2", "finite", 0.0)  # along -y
    kinematics: str = "stiffened"
    basis: str = "pinned-pinned"
    modes: int = 2  # bending modes, or frame elements
    axial_modes: int = 0  # of basis "pinned-pinned"; frame elements always extend

    def __post_init__(self) -> None:
        validate(self)
        require_choice("SliderCrank", "kinematics", self.kinematics, KINEMATICS)
        require_choice("SliderCrank", "basis", self.basis, KINDS)
        fewest, most = (0, MOST_MODES) if self.closed_form else (1, MOST_ELEMENTS)
        ranges = {"modes": (fewest, most), "axial_modes": (0, MOST_MODES if self.closed_form else 0)}
        for name, (least, greatest) in ranges.items():
            object.__setattr__(self, name, require_count("SliderCrank", name, getattr(self, name), least, greatest))
        speed, r, length = self.crank_speed, self.crank_radius, self.rod.length
        if speed is not None:
            object.__setattr__(self, "crank_speed", require_number("SliderCrank.crank_speed", speed, unit="rad/s"))
        if not (is_symbolic(r) or is_symbolic(length)):
            check_ratio("SliderCrank", "rod.length", r, length)

    @property
    def closed_form(self) -> bool:
        """Whether the rod bends in closed-form modes."""
        return self.basis == "pinned-pinned"

    @property
    def counts(self) -> tuple[int, int]:
        """How many bending and axial coordinates."""
        if self.kinematics == "rigid":
            return 0, 0
        return (self.modes, self.axial_modes) if self.closed_form else (2 * self.modes, self.modes)

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        n, k = self.counts
        bent = (Signal(f"eta{i + 1}", "m") for i in range(n))
        return Signal("crank_angle", "rad"), *bent, *(Signal(f"ext{i + 1}", "m") for i in range(k))

    @property
    def inputs(self) -> tuple[Signal, ...]:
        if self.crank_speed is None:
            return (Signal("torque", "N m"),)
        return (Signal("crank_acceleration", "rad/s^2"),)

    @property
    def driven(self) -> dict[int, int]:
        return {} if self.crank_speed is None else {0: 0}

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        """More force on the slider along -x; a force on the rod's middle along the rod's y."""
        return Signal("slider_force", "N"), Signal("middle_force", "N")

    @property
    def outputs(self) -> tuple[Signal, ...]:
        return (
            Signal("crank_angle", "rad"),
            Signal("slider_x", "m"),
            Signal("mid_deflection", "m"),  # across the rod, its local +y
            Signal("mid_extension", "m"),  # along the rod: extension less shortening
            Signal("mid_acceleration", "m/s^2"),  # absolute, component across the rod
            Signal("mid_acceleration_along", "m/s^2"),  # absolute, component along the rod
            Signal("mid_acceleration_elastic", "m/s^2"),  # second derivative of mid_deflection
            Signal("crank_pin_x", "N"),  # of the crank on the rod, inertial axes
            Signal("crank_pin_y", "N"),
            Signal("axial_force", "N"),  # in the rod at the slider, tension positive
            Signal("guide_force", "N"),  # of the guide on the slider, along +y
            Signal("crank_torque", "N m"),  # on the crank: the input, or what the prescribed motion needs
        )

    def sensors(self) -> tuple[Sensed, ...]:
        return Sensed("encoder", "crank_angle"), Sensed("accelerometer", "mid_acceleration")

    @property
    def deflections(self) -> tuple[str, ...]:
        return ("mid_deflection",)

    @property
    def cycle(self) -> str:
        return "crank_angle"

    @property
    def stiffening(self) -> tuple[Self, Self]:
        return self._of("linear"), self._of("stiffened")

    def _of(self, kinematics: str) -> Self:
        return self if self.kinematics == kinematics else dataclasses.replace(self, kinematics=kinematics)

    @property
    def label(self) -> str:
        if not sum(self.counts):
            return "rigid"
        if not self.closed_form:
            return f"{self.kinematics}, {self.modes} frame elements"
        axial = f"+{self.axial_modes} axial" if self.axial_modes else ""
        return f"{self.kinematics}, {self.modes}{axial} mode{'s' * (self.modes + self.axial_modes != 1)}"

    @property
    def rigid(self) -> RigidSliderCrank:
        """The mechanism with a rigid rod: exact kinematics, its inverse, and what the dead centres hide."""
        return RigidSliderCrank(self.crank_radius, self.rod.length)

    def state(self, angle: float = 0.0, speed: float | None = None) -> np.ndarray:
        """x (nx,) with the rod straight, the crank at `angle` [rad] and `speed` [rad/s] (None: crank_speed, or 0)."""
        x = np.zeros(self.nx)
        speed = self.crank_speed or 0.0 if speed is None else speed
        x[0] = require_number("SliderCrank.state.angle", angle, unit="rad")
        x[self.coordinates_slice.stop] = require_number("SliderCrank.state.speed", speed, unit="rad/s")
        return x

    @cached_property
    def elastic(self) -> PinnedRod:
        """The rod with its shape functions, which come from the nominal parameters."""
        own = self.nominal
        assert isinstance(own, SliderCrankMechanism)
        n, k = self.counts
        if self.closed_form or not k:
            shapes = rod_shapes("pinned-pinned", n, k, own.slider_mass / own.rod.mass if k else 0.0)
        else:
            shapes = rod_shapes("frame-elements", k)
        return PinnedRod(self.rod, shapes, self.kinematics == "stiffened")

    def _split(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        n = self.counts[0]
        return q[1 : 1 + n], q[1 + n :]

    def pin(self, q: ca.SX) -> ca.SX:
        """Position (2,) [m] of the crank pin."""
        return self.crank_radius * ca.vertcat(ca.cos(q[0]), ca.sin(q[0]))

    def direction(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(cos, sin) of the rod's angle phi2, which lies within a quarter turn: the loop closure."""
        sine = -self.pin(q)[1] / self.elastic.chord(*self._split(q))
        return ca.sqrt(1 - sine**2), sine

    def slider(self, q: ca.SX) -> ca.SX:
        """Slider position [m]."""
        return self.pin(q)[0] + self.elastic.chord(*self._split(q)) * self.direction(q)[0]

    def _rod_motion(self, q: ca.SX, v: ca.SX) -> tuple[tuple[ca.SX, ca.SX], ca.SX]:
        """Velocity of the crank pin in the rod's axes [m/s], rate of the rod's angle [rad/s]."""
        c, s = self.direction(q)
        x, y = ca.vertsplit(ca.jtimes(self.pin(q), q, v))
        return (c * x + s * y, c * y - s * x), ca.jtimes(s, q, v) / c

    def middle(self, q: ca.SX) -> ca.SX:
        """Position (2,) [m] of the rod's middle."""
        along, across = self.elastic.middle(*self._split(q))
        (c, s), along = self.direction(q), self.rod.length / 2 + along
        return self.pin(q) + ca.vertcat(c * along - s * across, s * along + c * across)

    def outline(self, x: np.ndarray, points: int = 30) -> np.ndarray:
        """Crank and bent rod at a state x (nx,): inertial positions (2, points, 2) [m]."""
        x, points = one_state(self, x), line_points(self, points)
        n, q = self.counts[0], x[self.coordinates_slice]
        pin, frame = (
            np.array(ca.evalf(e)).ravel() for e in (self.pin(ca.SX(q)), ca.vertcat(*self.direction(ca.SX(q))))
        )
        xi = np.linspace(0.0, 1.0, points)
        line = self.elastic.link.centreline(q[1 : 1 + n], points)
        line[:, 0] += self.elastic.shapes.psi(xi) @ q[1 + n :]
        c, s = frame
        return np.stack([xi[:, None] * pin, pin + line @ np.array([[c, s], [-s, c]])])

"""Slider-crank with a rigid crank and an elastic connecting rod, pinned at both ends.

States   q = [crank_angle, eta1 .. etan, ext1 .. extk], x = [q; dq/dt]; angles from the slider's line +x
Input    crank torque [N m], or crank acceleration [rad/s^2] where the crank's motion is prescribed (crank_speed)
Outputs  crank angle, slider position, deflection and accelerations of the rod's middle, forces, crank torque
Valid    planar; deflection small against the rod; frictionless pins; crank balanced about its shaft
Source   "Elastodynamic Analysis of a Mechanism with Flexible Links". Departures: lambda = r/l, not l/r; the loop
         closure is exact, sin phi2 = -r sin phi1/c with c the distance of the rod's pins, not the series (24);
         c = l + extension - shortening, which gives the geometric stiffness of the axial force that (22) lacks;
         the rod's absolute rates take the place of omega1 - omega2 in (34)-(36), (42), (45).
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.beams.pinned_rod import KINDS, MOST_ELEMENTS, PinnedRod, rod_shapes
from pliant.plants.beams.section import Beam, Material
from pliant.plants.core.parameters import is_symbolic, quantity, require_choice, require_count, validate
from pliant.plants.core.signals import Sensed, Signal
from pliant.plants.dynamics.lagrangian import LagrangianPlant

from .rigid_kinematics import RigidSliderCrank, check_ratio

KINEMATICS = ("rigid", "linear", "stiffened")
MOST_MODES = 40
DRY_SPEED = 1e-2  # [m/s] over which dry friction changes its sign


@dataclass(frozen=True, kw_only=True)
class SliderCrank(LagrangianPlant):
    """M(q) q'' = tau + dT/dq - M' q' - dV/dq - dD/dv with r sin phi1 + c(q) sin phi2 = 0 solved for phi2."""

    crank_radius: float = quantity("m", "positive")
    rod: Beam
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
        require_count("SliderCrank", "modes", self.modes, fewest, most)
        require_count("SliderCrank", "axial_modes", self.axial_modes, 0, MOST_MODES if self.closed_form else 0)
        speed, r, length = self.crank_speed, self.crank_radius, self.rod.length
        if speed is not None and not (isinstance(speed, (int, float)) and math.isfinite(speed)):
            raise ValueError(f"SliderCrank.crank_speed = {speed!r} must be None or a finite number [rad/s]")
        if not (is_symbolic(r) or is_symbolic(length)):
            check_ratio("SliderCrank", "rod.length", r, length)

    @classmethod
    def textbook(cls) -> Self:
        """The paper's r = 55 mm, l = 280 mm, Q = 20 N, 144 rpm, E and density, with a section that it does not give.

        Section 10 mm by 4 mm (bending along the 4 mm), slider 0.2 kg, crank 1e-3 kg m^2, damping 2 % of the first mode.
        """
        steel = Material(density=7700.0, E=210e9, G=210e9 / (2 * 1.28))
        rod = Beam.rectangular(0.28, width=0.01, depth=0.004, material=steel)
        first = (math.pi / rod.length) ** 2 * math.sqrt(rod.EI / rod.linear_density)
        return cls(
            crank_radius=0.055,
            rod=dataclasses.replace(rod, damping=2 * 0.02 / first),
            slider_mass=0.2,
            force=20.0,
            crank_speed=2 * math.pi * 144 / 60,
            crank_inertia=1e-3,
        )

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
        return f"{self.kinematics}, {self.modes}{axial} modes"

    def ladder(self) -> tuple[Self, ...]:
        """From the rigid rod through one to five modes, with and without shortening."""
        steps: list[Self] = [dataclasses.replace(self, kinematics="rigid")]
        for kinematics, n in (("linear", 1), ("linear", 3), *(("stiffened", n) for n in (1, 2, 3, 5))):
            changes: dict[str, Any] = {"kinematics": kinematics, "basis": "pinned-pinned", "modes": n}
            steps.append(dataclasses.replace(self, axial_modes=0, **changes))
        return tuple(steps)

    @property
    def rigid(self) -> RigidSliderCrank:
        """The mechanism with a rigid rod: exact kinematics, its inverse, and what the dead centres hide."""
        return RigidSliderCrank(self.crank_radius, self.rod.length)

    def state(self, angle: float = 0.0, speed: float | None = None) -> np.ndarray:
        """x (nx,) with the rod straight, the crank at `angle` [rad] and `speed` [rad/s] (None: crank_speed, or 0)."""
        x = np.zeros(self.nx)
        x[0], x[self.nx // 2] = angle, (self.crank_speed or 0.0) if speed is None else speed
        return x

    # --- energies ------------------------------------------------------------------------------------------------
    @cached_property
    def elastic(self) -> PinnedRod:
        """The rod with its shape functions, which come from the nominal parameters."""
        own = self.nominal
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

    def _rod_kinetic_energy(self, pin: tuple[ca.SX, ca.SX], rate: ca.SX, q: ca.SX, v: ca.SX) -> ca.SX:
        return self.elastic.kinetic_energy(pin, rate, *self._split(q), *self._split(v))

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        speed = ca.jtimes(self.slider(q), q, v)
        rod = self._rod_kinetic_energy(*self._rod_motion(q, v), q, v)
        return self.crank_inertia * v[0] ** 2 / 2 + rod + self.slider_mass * speed**2 / 2

    def potential_energy(self, q: ca.SX) -> ca.SX:
        x, y = self.elastic.centre(*self._split(q))
        c, s = self.direction(q)
        height = self.rod.mass * self.pin(q)[1] + s * x + c * y
        return self.gravity * height + self.elastic.strain_energy(*self._split(q))

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        speed = ca.jtimes(self.slider(q), q, v)
        dry = self.dry_friction * DRY_SPEED * (ca.sqrt(1 + (speed / DRY_SPEED) ** 2) - 1)
        lost = self.crank_friction * v[0] ** 2 / 2 + self.slider_friction * speed**2 / 2 + dry
        return lost + self.elastic.dissipation(*self._split(v))

    def middle(self, q: ca.SX) -> ca.SX:
        """Position (2,) [m] of the rod's middle."""
        along, across = self.elastic.middle(*self._split(q))
        (c, s), along = self.direction(q), self.rod.length / 2 + along
        return self.pin(q) + ca.vertcat(c * along - s * across, s * along + c * across)

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        c, s = self.direction(q)
        push = w[1] * ca.vertcat(-s, c)
        force = ca.jtimes(self.middle(q), q, push, True) - (self.force + w[0]) * ca.gradient(self.slider(q), q)
        if self.crank_speed is None:
            force[0] += u[0]
        return force

    # --- outputs -------------------------------------------------------------------------------------------------
    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        n = x.shape[0] // 2
        q, v = x[:n], x[n:]
        M, r, _, _ = self.equations(t, x, u, w)
        a = self.acceleration(M, r, u)[0]
        c, s = self.direction(q)
        shift = ca.vertcat(*self.elastic.middle(*self._split(q)))
        moved = _second(self.middle(q), q, v, a)
        pin, slider = self._reactions(q, v, a, w)
        torque = self.crank_inertia * a[0] + self.crank_friction * v[0]
        torque += self.crank_radius * (ca.cos(q[0]) * pin[1] - ca.sin(q[0]) * pin[0])
        return ca.vertcat(
            q[0],
            self.slider(q),
            shift[1],
            shift[0],
            c * moved[1] - s * moved[0],
            c * moved[0] + s * moved[1],
            _second(shift[1], q, v, a),
            pin,
            c * slider[0] + s * slider[1],
            slider[1] + self.slider_mass * self.gravity,
            torque,
        )

    def _reactions(self, q: ca.SX, v: ca.SX, a: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Forces (2,) [N] on the rod, inertial axes: of the crank, of the slider.

        Kirchhoff's equations of the rod as a free body in its own axes: momentum (2,) and moment of momentum about
        the crank pin are dT/d(pin velocity) and dT/d(rate).
        """
        pin, rate = self._rod_motion(q, v)
        free = ca.SX.sym("free", 3)
        momenta = ca.gradient(self._rod_kinetic_energy((free[0], free[1]), free[2], q, v), free)
        [P] = ca.substitute([momenta], [free], [ca.vertcat(*pin, rate)])
        load = ca.jtimes(P, q, v) + ca.jtimes(P, v, a)
        load += ca.vertcat(-rate * P[1], rate * P[0], pin[0] * P[1] - pin[1] * P[0])
        (c, s), (x, y) = self.direction(q), self.elastic.centre(*self._split(q))
        load += self.gravity * ca.vertcat(self.rod.mass * s, self.rod.mass * c, c * x - s * y)
        load -= w[1] * ca.vertcat(0, 1, self.rod.length / 2 + self.elastic.middle(*self._split(q))[0])
        speed = ca.jtimes(self.slider(q), q, v)
        drag = self.slider_friction * speed
        drag += self.dry_friction * speed / ca.sqrt(speed**2 + DRY_SPEED**2)
        along = -(self.slider_mass * _second(self.slider(q), q, v, a) + self.force + w[0] + drag)
        across = load[2] / self.elastic.chord(*self._split(q))  # in the rod's axes
        slider = ca.vertcat(along, (s * along + across) / c)
        return ca.vertcat(c * load[0] - s * load[1], s * load[0] + c * load[1]) - slider, slider

    def outline(self, x: np.ndarray, points: int = 30) -> np.ndarray:
        """Crank and bent rod at a state x (nx,): inertial positions (2, points, 2) [m]."""
        n, q = self.counts[0], x[: self.nx // 2]
        pin, frame = (
            np.array(ca.evalf(e)).ravel() for e in (self.pin(ca.SX(q)), ca.vertcat(*self.direction(ca.SX(q))))
        )
        xi = np.linspace(0.0, 1.0, points)
        line = self.elastic.link.centreline(q[1 : 1 + n], points)
        line[:, 0] += self.elastic.shapes.psi(xi) @ q[1 + n :]
        c, s = frame
        return np.stack([xi[:, None] * pin, pin + line @ np.array([[c, s], [-s, c]])])


def _second(e: ca.SX, q: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
    """d2e/dt2 of an expression of q alone."""
    return ca.jtimes(ca.jtimes(e, q, v), q, v) + ca.jtimes(e, q, a)

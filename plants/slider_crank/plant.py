"""Slider-crank with a rigid crank and an elastic connecting rod, pinned at both ends.

States   q = [crank_angle, eta1 .. etan, ext1 .. extk], x = [q; dq/dt]; angles from the slider's line +x
Input    crank torque [N m], or crank acceleration [rad/s^2] where the crank's motion is prescribed (crank_speed)
Outputs  crank angle, slider position, deflection and accelerations of the rod's middle, forces, crank torque
Valid    planar; slopes of the rod up to 0.3 rad, see `ranges`; frictionless pins; crank balanced about its shaft
Source   "Elastodynamic Analysis of a Mechanism with Flexible Links". Departures: lambda = r/l, not l/r; the loop
         closure is exact, sin phi2 = -r sin phi1/c with c the distance of the rod's pins, not the series (24);
         c = l + extension - shortening, which gives the geometric stiffness of the axial force that (22) lacks;
         the rod's absolute rates take the place of omega1 - omega2 in (34)-(36), (42), (45).
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, Self

import casadi as ca

from pliant.plants.beams.elastic_link import second_derivative
from pliant.plants.beams.section import Beam, Material
from pliant.plants.core.signals import index
from pliant.plants.validity.ranges import Range
from pliant.plants.validity.slender import NONE_HOLDS, pinned

from .mechanism import MOST_MODES, SliderCrankMechanism

PHYSICS_MODES = 5  # that physics has by itself
DRY_SPEED = 1e-2  # [m/s] over which dry friction changes its sign


@dataclass(frozen=True, kw_only=True)
class SliderCrank(SliderCrankMechanism):
    """M(q) q'' = tau + dT/dq - M' q' - dV/dq - dD/dv with r sin phi1 + c(q) sin phi2 = 0 solved for phi2."""

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

    def ladder(self) -> tuple[Self, ...]:
        """From the rigid rod through one to five modes, with and without shortening."""
        steps: list[Self] = [dataclasses.replace(self, kinematics="rigid")]
        for kinematics, n in (("linear", 1), ("linear", 3), *(("stiffened", n) for n in (1, 2, 3, 5))):
            changes: dict[str, Any] = {"kinematics": kinematics, "basis": "pinned-pinned", "modes": n}
            steps.append(dataclasses.replace(self, axial_modes=0, **changes))
        return tuple(steps)

    def physics(self, more: int = 0) -> Self:
        """Stiffened, with `more` than five modes of the pinned rod."""
        modes = min(PHYSICS_MODES + more, MOST_MODES)
        return dataclasses.replace(self, kinematics="stiffened", basis="pinned-pinned", modes=modes, axial_modes=0)

    @property
    def planar_chain(self) -> str:
        return "the rod between a crank and a slider is a closed loop, not a chain"

    @property
    def effects(self) -> dict[str, bool]:
        bends = self.kinematics != "rigid" and self.modes > 0
        return {"bending": bends, "shortening of the bent rod": bends and self.kinematics == "stiffened"}

    def _lacking(self, effect: str) -> Self:
        changes: dict[str, dict[str, Any]] = {
            "bending": {"kinematics": "rigid"},
            "shortening of the bent rod": {"kinematics": "linear"},
        }
        return dataclasses.replace(self, **changes[effect])

    @property
    def unmodelled(self) -> tuple[str, ...]:
        return "exact rotations of the rod", "shear and rotary inertia of the rod", "clearance of the joints"

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

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        c, s = self.direction(q)
        push = w[1] * ca.vertcat(-s, c)
        force = ca.jtimes(self.middle(q), q, push, True) - (self.force + w[0]) * ca.gradient(self.slider(q), q)
        if self.crank_speed is None:
            force[0] += u[0]
        return force

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        M, r, _, _ = self.equations(t, x, u, w)
        return self.output_at(t, x, u, w, self.acceleration(M, r, u)[0])

    def output_at(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        n = self.coordinates_slice.stop
        q, v = x[:n], x[n:]
        c, s = self.direction(q)
        shift = ca.vertcat(*self.elastic.middle(*self._split(q)))
        moved = second_derivative(self.middle(q), q, v, a)
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
            second_derivative(shift[1], q, v, a),
            pin,
            c * slider[0] + s * slider[1],
            slider[1] + self.slider_mass * self.gravity,
            torque,
        )

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """Small slopes and strains; without stiffening also the shortening and the axial force that it leaves out."""
        if self.kinematics == "rigid":
            return ()
        bent, _ = self._split(x[: self.coordinates_slice.stop])
        axial = y[index(self.outputs, "axial_force", "output")]
        return tuple(pinned("the rod", self.elastic, bent, axial, f"{NONE_HOLDS} for mechanisms"))

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
        along = -(self.slider_mass * second_derivative(self.slider(q), q, v, a) + self.force + w[0] + drag)
        across = load[2] / self.elastic.chord(*self._split(q))  # in the rod's axes
        slider = ca.vertcat(along, (s * along + across) / c)
        return ca.vertcat(c * load[0] - s * load[1], s * load[0] + c * load[1]) - slider, slider

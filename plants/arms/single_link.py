"""Single flexible link on a driven hub, with a rigid payload at its tip.

States   q = [hub_angle, eta1 .. etan], x = [q; dq/dt]; in another frame than the clamped one, q = [frame_angle, ..]
Input    hub torque [N m], or hub acceleration [rad/s^2] where the hub's motion is prescribed (drive="motion")
Outputs  hub angle [rad], tip deflection [m] and its rate [m/s], tip position [m], curvature at the root [1/m] and what
         an accelerometer at the tip reads across its section [m/s^2]; disturbance: force on the tip [N]
Valid    planar; slopes up to 0.3 rad, any with kinematics="strain"; "linear" up to a fifth of the first bending
         frequency of spin: `ranges`. Links keep their length unless "strain" and "timoshenko" are `extensible`: two
         coordinates more, stretch1 and stretch2, whose frequencies are those of waves along the axis
Source   "On the dynamic modelling of flexible manipulators", Eqs (13)-(16), corrected: (13) lacks the centripetal
         term, the geometric stiffness is -thetadot^2 Xi22 with tip mass and beam, Xi33 is zero. With theory
         "timoshenko" each coordinate bends and shears, (W, Psi) = (w_k, psi_k), so that p and q are one vector
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import casadi as ca
import numpy as np

from pliant.plants import beams
from pliant.plants.beams.elastic_link import payload_energy, payload_position, second_derivative
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import real_array, require_choice, require_finite
from pliant.plants.core.casadi_functions import last_call
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.dynamics.arguments import line_points, one_state
from pliant.plants.exact_rotations.strain_link import StrainLink
from pliant.plants.validity.ranges import Range
from pliant.plants.validity.rotating_sections import strains_of
from pliant.plants.validity.slender import Pull, pulled, small_slopes

from . import small_slope_equations
from .exact_rotation_equations import of_single_link, written_out
from .link_frames import FRAMES, to_clamped
from .single_link_declaration import SingleLinkDeclaration

LARGE = 'kinematics="strain"'


@dataclass(frozen=True, kw_only=True)
class SingleLinkArm(SingleLinkDeclaration):
    """[mu11 + p.Xi p] theta'' + m12 p'' + 2 theta' p'.Xi p = tau;  m12 theta'' + M p'' + (K - theta'^2 Xi) p = 0."""

    @classmethod
    def textbook(cls) -> Self:
        """A 1 m steel strip, h/L = 0.01 as in the paper's Figures 4-5, on a hub as heavy to turn as the strip.

        Section 50 mm by 10 mm, bending along the 10 mm; payload 1 kg; no damping.
        """
        strip = Beam.rectangular(1.0, width=0.05, depth=0.01, material=beams.STEEL)
        return cls(link=strip, hub_inertia=1.3, payload=Payload(mass=1.0, inertia=0.001))

    @property
    def stiffening(self) -> tuple[Self, Self]:
        return self._of("linear"), self._of("stiffened")

    def _of(self, kinematics: str) -> Self:
        return self if self.kinematics == kinematics else dataclasses.replace(self, kinematics=kinematics)

    def ladder(self) -> tuple[Self, ...]:
        """From the rigid link through one to four modes, with and without shortening, to exact rotations.

        Modes of a free tip know nothing of a payload's force and moment; above them stands one rung that does. Exact
        rotations are had in the clamped frame alone.
        """
        plain = self.inextensible
        steps: list[Self] = [dataclasses.replace(plain, kinematics="rigid")]
        for kinematics, n in (
            ("linear", 1),
            ("linear", 2),
            ("stiffened", 1),
            ("stiffened", 2),
            ("stiffened", 3),
            ("stiffened", 4),
        ):
            steps.append(dataclasses.replace(plain, kinematics=kinematics, modes=n))
        if self.basis == "clamped-free":
            steps.append(dataclasses.replace(steps[-1], basis="payload"))
        for n in (2, 3, 4) if self.frame == "clamped" else ():
            steps.append(dataclasses.replace(steps[-1], kinematics="strain", modes=n))
        return tuple(steps)

    @cached_property
    def clamped_map(self) -> np.ndarray:
        """(1 + n, 1 + n): [hub_angle; clamped modal coordinates] from this arm's coordinates; the nominal's numbers."""
        own = self.nominal
        return to_clamped(dataclasses.replace(own, frame="clamped", drive="torque", varied=()), self.frame)

    def frame_map(self, frame: str) -> np.ndarray:
        """T (1 + n, 1 + n), Eq (1): coordinates in `frame` from this arm's; rates likewise. [:, 0] = (1, 0, ..)."""
        require_choice("SingleLinkArm.frame_map", "frame", frame, FRAMES)
        other = dataclasses.replace(self, frame=frame, drive="torque")
        return np.linalg.solve(other.clamped_map, self.clamped_map)

    def in_frame(self, frame: str, x: np.ndarray) -> tuple[Self, np.ndarray]:
        """This arm described in `frame`, and its states (..., nx) from this arm's states x (..., nx).

        States are [rad] and [m]. ValueError for another shape of x.
        """
        T, n = self.frame_map(frame), self.coordinates_slice.stop
        x = real_array("SingleLinkArm.in_frame.x", x)
        if x.shape[-1:] != (self.nx,):
            raise ValueError(f"SingleLinkArm.in_frame.x has shape {x.shape}, must be (..., {self.nx})")
        x = require_finite("SingleLinkArm.in_frame.x", x, x.shape)
        moved = np.concatenate([x[..., :n] @ T.T, x[..., n:] @ T.T], axis=-1)
        return dataclasses.replace(self, frame=frame), moved

    def _clamped(self, q: ca.SX) -> ca.SX:
        """[hub_angle; clamped modal coordinates] (1 + n,) from this arm's coordinates, or their rates."""
        return q if self.frame == "clamped" else ca.DM(self.clamped_map) @ q

    @property
    def _offset_load(self) -> bool:
        return any(is_symbolic(o) or o != 0.0 for o in self.payload.offset[:2])

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        q, v = self._clamped(q), self._clamped(v)
        link, omega, p, p_rate = self.elastic, v[0], q[1:], v[1:]
        root = (ca.SX(0), self.hub_radius * omega)
        tip = link.tip_velocity(root, omega, p, p_rate)
        turning = omega + link.slope(p_rate)
        return (
            self.hub_inertia * omega**2 / 2
            + link.kinetic_energy(root, omega, p, p_rate)
            + payload_energy(self.payload, tip, turning, link.slope(p), self._offset_load)
        )

    def potential_energy(self, q: ca.SX) -> ca.SX:
        q = self._clamped(q)
        link, p = self.elastic, q[1:]
        x, y = link.centre(p)
        xp, yp = payload_position(self.payload, link.tip(p), link.slope(p), self._offset_load)
        x = x + self.payload.mass * xp + (self.link.mass + self.payload.mass) * self.hub_radius
        y = y + self.payload.mass * yp
        return self.gravity * (ca.sin(q[0]) * x + ca.cos(q[0]) * y) + link.strain_energy(p)

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        v = self._clamped(v)
        return self.hub_friction * v[0] ** 2 / 2 + self.elastic.dissipation(v[1:])

    @last_call
    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        if self.frame == "clamped" and small_slope_equations.of_small_slopes(self.elastic):
            return small_slope_equations.of_single_link(self, x, u, w, self._offset_load)
        if written_out(self.elastic):
            return of_single_link(self, x, u, w, self._offset_load)
        return super().equations(t, x, u, w)

    def _tip(self, q: ca.SX) -> ca.SX:
        q = self._clamped(q)
        x, y = self.elastic.tip(q[1:])
        x = x + self.hub_radius
        c, s = ca.cos(q[0]), ca.sin(q[0])
        return ca.vertcat(c * x - s * y, s * x + c * y)

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        force = ca.jtimes(self._tip(q), q, w, True)
        if self.drive == "torque":
            force += ca.gradient(self._clamped(q)[0], q) * u[0]
        return force

    @property
    def _written_out(self) -> bool:
        return self.frame == "clamped" and small_slope_equations.of_small_slopes(self.elastic)

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        M, r, _, _ = self.equations(t, x, u, w)
        return self.output_at(t, x, u, w, self.acceleration(M, r, u)[0])

    def output_at(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        n = self.coordinates_slice.stop
        tip, link = self._tip(x[:n]), self.elastic
        q, v = self._clamped(x[:n]), self._clamped(x[n:])
        bent = [q[0], link.deflection(q[1:]), link.deflection_rate(q[1:], v[1:])]
        felt = self._felt(x, a, q[0] + link.slope(q[1:]))
        return ca.vertcat(*bent, tip, link.root_curvature(q[1:]), felt)

    def _felt(self, x: ca.SX, a: ca.SX, angle: ca.SX) -> ca.SX:
        """The tip's acceleration less gravity, across a section that stands at `angle` to the x axis."""
        n = self.coordinates_slice.stop
        a = second_derivative(self._tip(x[:n]), x[:n], x[n:], a)
        return ca.cos(angle) * (a[1] + self.gravity) - ca.sin(angle) * a[0]

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """Small slopes, without stiffening also the shortening and the axial force that it leaves out; of
        exact rotations small strains.
        """
        n = self.coordinates_slice.stop
        q, spin, link, load = self._clamped(x[:n]), self._clamped(x[n:])[0] ** 2, self.elastic, self.payload
        c, s = ca.cos(q[0]), ca.sin(q[0])
        out = spin * (self.hub_radius + link.beam.length + load.offset[0]) - self.gravity * s
        force = load.mass * out + c * w[0] + s * w[1]
        pull = Pull(spin * self.hub_radius - self.gravity * s, spin, force)
        name = "the link"
        if isinstance(link, StrainLink):
            return tuple(strains_of(name, link, q[1:], pull.at_root(link)))
        return (*small_slopes(name, link, q[1:], LARGE), *pulled(name, link, self.nominal.elastic, pull))

    def outline(self, x: np.ndarray, points: int = 30) -> np.ndarray:
        """The bent link from hub to tip at a state x (nx,): inertial positions (1, points, 2) [m]."""
        x, points = one_state(self, x), line_points(self, points)
        q = self.clamped_map @ x[self.coordinates_slice]
        line = self.elastic.centreline(q[1:], points) + np.array([self.hub_radius, 0.0])
        c, s = np.cos(q[0]), np.sin(q[0])
        return (line @ np.array([[c, s], [-s, c]]))[None]

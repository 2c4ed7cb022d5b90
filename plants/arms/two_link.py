"""Planar arm of two elastic links with a motor at each joint and a payload at its end.

States   q = [theta1, theta2, q11 .. q1n, q21 .. q2m], x = [q; dq/dt]; theta2 relative to link 1's tip
Inputs   joint torques tau1, tau2 [N m]; disturbances: force on the tip, inertial axes [N]
Outputs  joint angles [rad], tip deflections of both links [m] and their rates [m/s], tip position [m], curvature at
         each link's root [1/m], what an accelerometer at the tip reads across its section [m/s^2]
Valid    planar; slopes up to 0.3 rad, any with kinematics="strain"; fast rotation and axial loads need "stiffened" or
         "strain": `ranges`. Links keep their lengths unless "strain" and "timoshenko" are `extensible`: two
         coordinates a link more
Source   "Coupled-Nonlinear Elastic Structure", Eqs (5)-(27). Departures: the strain energy of (23) has the sign +,
         gravity acts on the deflections too, the payload turns with (21)'s slope plus the joint angles.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Self

import casadi as ca
import numpy as np

from pliant.plants import beams
from pliant.plants.beams.elastic_link import payload_energy, payload_position, second_derivative
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.casadi_functions import last_call
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.dynamics.arguments import line_points, one_state
from pliant.plants.exact_rotations.strain_link import StrainLink
from pliant.plants.validity.ranges import Range
from pliant.plants.validity.rotating_sections import strains_of
from pliant.plants.validity.slender import Pull, pulled, small_slopes

from . import exact_rotation_equations, small_slope_equations
from .exact_rotation_equations import written_out
from .small_slope_equations import in_absolute_angles, of_small_slopes
from .two_link_declaration import TwoLinkDeclaration

TURNED = 0.01  # [rad], of link 2 by link 1's tip: a hundredth of its length at its own tip
LARGE = 'kinematics="strain"'


@dataclass(frozen=True, kw_only=True)
class TwoLinkArm(TwoLinkDeclaration):
    """M(q) q'' + h(q, q') + K q + g(q) = B tau, with the paper's staged reduction to the rigid arm."""

    @classmethod
    def textbook(cls) -> Self:
        """Two 1 m aluminium strips, 40 mm by 8 mm: a set with the paper's proportions (the paper prints none).

        E = 70 GPa, density 2700 kg/m^3, joint mass 1 kg, payload 0.5 kg and 0.002 kg m^2; no hub inertia, no damping.
        """
        strip = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.Material(density=2700.0, E=70e9, G=26e9))
        return cls(link1=strip, link2=strip, joint_mass=1.0, payload=Payload(mass=0.5, inertia=0.002))

    @property
    def stiffening(self) -> tuple[Self, Self]:
        return self._of("linear"), self._of("stiffened")

    def _of(self, kinematics: str) -> Self:
        return self if self.kinematics == kinematics else dataclasses.replace(self, kinematics=kinematics)

    def ladder(self) -> tuple[Self, ...]:
        """From the rigid arm through modes to four polynomials a link, with shortening and with exact rotations."""
        plain = self.inextensible
        steps: list[Self] = [dataclasses.replace(plain, reduction="rigid")]
        for kinematics, basis, n in (
            ("linear", "clamped-free", 1),
            ("linear", "clamped-free", 2),
            ("linear", "polynomial", 2),
            ("linear", "polynomial", 3),
            ("stiffened", "payload", 2),
            ("stiffened", "polynomial", 2),
            ("stiffened", "polynomial", 3),
            ("stiffened", "clamped-free", 4),
            ("stiffened", "polynomial", 4),
            ("strain", "polynomial", 3),
            ("strain", "polynomial", 4),
        ):
            steps.append(
                dataclasses.replace(
                    plain, reduction="full", tip_slope=True, kinematics=kinematics, basis=basis, modes=(n, n)
                )
            )
        return tuple(steps)

    @property
    def _offset_load(self) -> bool:
        return any(is_symbolic(o) or o != 0.0 for o in self.payload.offset[:2])

    def _exact_kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        (_, theta2, q1, q2), (w1, theta2_rate, v1, v2) = self._split(q), self._split(v)
        link1, link2 = self.links
        joint = link1.tip_velocity((ca.SX(0), ca.SX(0)), w1, q1, v1)
        turn, w2 = theta2, w1 + theta2_rate
        if self.tip_slope:
            turn, w2 = turn + link1.slope(q1), w2 + link1.slope(v1)
        c, s = ca.cos(turn), ca.sin(turn)
        root = (c * joint[0] + s * joint[1], c * joint[1] - s * joint[0])
        return (
            link1.kinetic_energy((ca.SX(0), ca.SX(0)), w1, q1, v1)
            + self.hub_inertia[0] * w1**2 / 2
            + self.joint_mass * (joint[0] ** 2 + joint[1] ** 2) / 2
            + self.hub_inertia[1] * w2**2 / 2
            + link2.kinetic_energy(root, w2, q2, v2)
            + payload_energy(
                self.payload,
                link2.tip_velocity(root, w2, q2, v2),
                w2 + link2.slope(v2),
                link2.slope(q2),
                self._offset_load,
            )
        )

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """T of the chosen stage; ERRATA-corrected stages of the paper's reduction.

        "rigid-inertia" takes M11 and M22 at zero deflection, "rigid-coupling" all of M.
        """
        straight = ca.vertcat(q[:2], ca.SX.zeros(q.shape[0] - 2))
        if self.reduction == "rigid-coupling":
            return self._exact_kinetic_energy(straight, v)
        T = self._exact_kinetic_energy(q, v)
        if self.reduction == "rigid-inertia":
            for i in (0, 1):
                unit = ca.SX.zeros(q.shape[0])
                unit[i] = v[i]
                T += self._exact_kinetic_energy(straight, unit) - self._exact_kinetic_energy(q, unit)
        return T

    def _heights(self, q: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """(cos, sin) of link 1's and of link 2's root direction against the inertial x axis."""
        theta1, theta2, q1, _ = self._split(q)
        turn = theta2 + self.links[0].slope(q1) if self.tip_slope else theta2
        c1, s1, c, s = ca.cos(theta1), ca.sin(theta1), ca.cos(turn), ca.sin(turn)
        return c1, s1, c1 * c - s1 * s, s1 * c + c1 * s

    def potential_energy(self, q: ca.SX) -> ca.SX:
        _, _, q1, q2 = self._split(q)
        link1, link2 = self.links
        c1, s1, c12, s12 = self._heights(q)
        (x1, y1), (x2, y2), (xe, ye) = link1.centre(q1), link2.centre(q2), link1.tip(q1)
        xp, yp = payload_position(self.payload, link2.tip(q2), link2.slope(q2), self._offset_load)
        beyond = self.joint_mass + self.link2.mass + self.payload.mass
        lifted = (
            s1 * (x1 + beyond * xe)
            + c1 * (y1 + beyond * ye)
            + s12 * (x2 + self.payload.mass * xp)
            + c12 * (y2 + self.payload.mass * yp)
        )
        return self.gravity * lifted + link1.strain_energy(q1) + link2.strain_energy(q2)

    @last_call
    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        small, whole = of_small_slopes(self.links[0]), self.reduction in ("full", "rigid")
        if not whole or not (small or written_out(self.links[0])):
            return super().equations(t, x, u, w)
        by = small_slope_equations if small else exact_rotation_equations
        return by.of_two_links(self, x, u, w, self._offset_load)

    @last_call
    def solved(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        if self.reduction not in ("full", "rigid") or not of_small_slopes(self.links[0]):
            return super().solved(t, x, u, w)
        y, pivots = self.acceleration(*in_absolute_angles(self, x, u, w, self._offset_load), u)
        return small_slope_equations.relative(self, y), pivots

    def _tip(self, q: ca.SX) -> ca.SX:
        _, _, q1, q2 = self._split(q)
        c1, s1, c12, s12 = self._heights(q)
        (xe, ye), (xt, yt) = self.links[0].tip(q1), self.links[1].tip(q2)
        return ca.vertcat(c1 * xe - s1 * ye + c12 * xt - s12 * yt, s1 * xe + c1 * ye + s12 * xt + c12 * yt)

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        torque = ca.vertcat(u, ca.SX.zeros(q.shape[0] - 2))
        return torque + ca.jtimes(self._tip(q), q, w, True)

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        return self.output_at(t, x, u, w, self.solved(t, x, u, w)[0])

    def output_at(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        n = self.coordinates_slice.stop
        q, v = x[:n], x[n:]
        (theta1, theta2, q1, q2), (_, _, v1, v2) = self._split(q), self._split(v)
        link1, link2 = self.links
        bent = [
            link1.deflection(q1),
            link2.deflection(q2),
            link1.deflection_rate(q1, v1),
            link2.deflection_rate(q2, v2),
        ]
        bent += [self._tip(q), link1.root_curvature(q1), link2.root_curvature(q2)]
        a = second_derivative(self._tip(q), q, v, a)
        _, _, c12, s12 = self._heights(q)
        c, s = ca.cos(link2.slope(q2)), ca.sin(link2.slope(q2))
        felt = (c * c12 - s * s12) * (a[1] + self.gravity) - (s * c12 + c * s12) * a[0]
        return ca.vertcat(theta1, theta2, *bent, felt)

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """Small slopes, without stiffening also the shortening and the axial force that it leaves out; of
        exact rotations small strains.
        """
        n = self.coordinates_slice.stop
        q, v, links = x[:n], x[n:], self.links
        (_, _, q1, q2), (w1, w2, v1, _) = self._split(q), self._split(v)
        c1, s1, c12, s12 = self._heights(q)
        spin1, spin2 = w1**2, (w1 + w2 + (links[0].slope(v1) if self.tip_slope else 0)) ** 2
        L1, L2, m2, mp, g = self.link1.length, self.link2.length, self.link2.mass, self.payload.mass, self.gravity
        beyond, aligned = self.joint_mass + m2 + mp, c1 * c12 + s1 * s12
        out = (m2 / 2 + mp) * L2 * spin2 * aligned + c1 * w[0] + s1 * w[1]  # of the second link's own spin
        root = L1 * spin1 * aligned - g * s12
        pulls = (
            Pull(-g * s1, spin1, beyond * (L1 * spin1 - g * s1) + out),
            Pull(root, spin2, mp * (root + L2 * spin2) + c12 * w[0] + s12 * w[1]),
        )
        found = list[Range]()
        for i, (link, numbers, bent, pull) in enumerate(zip(links, self.nominal.links, (q1, q2), pulls), start=1):
            if isinstance(link, StrainLink):
                found += strains_of(f"link {i}", link, bent, pull.at_root(link))
            else:
                found += small_slopes(f"link {i}", link, bent, LARGE) + pulled(f"link {i}", link, numbers, pull)
        if not self.tip_slope and q1.shape[0]:
            keeps = "leaving it out misplaces the tip by less than 1 % of link 2's length"
            turned = ca.fabs(links[0].slope(q1))
            found.append(Range("slope of link 1's tip", "rad", TURNED, keeps, "tip_slope=True", turned))
        return tuple(found)

    def outline(self, x: np.ndarray, points: int = 30) -> np.ndarray:
        """Both bent links from root to tip at a state x (nx,): inertial positions (2, points, 2) [m]."""
        x, points = one_state(self, x), line_points(self, points)
        n, n1 = self.coordinates_slice.stop, self.mode_counts[0] + self.stretches
        link1, link2 = self.links
        q1 = x[2 : 2 + n1]
        turn = x[0] + x[1] + (link1.basis.tip_slope @ q1 / link1.beam.length if self.tip_slope else 0.0)
        (c1, s1), (c2, s2) = (np.cos(x[0]), np.sin(x[0])), (np.cos(turn), np.sin(turn))
        first = link1.centreline(q1, points) @ np.array([[c1, s1], [-s1, c1]])
        second = link2.centreline(x[2 + n1 : n], points) @ np.array([[c2, s2], [-s2, c2]])
        return np.stack([first, first[-1] + second])

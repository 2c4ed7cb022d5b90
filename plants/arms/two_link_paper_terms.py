"""The equations of TwoLinkArm in the paper's parameterisation: J_i q_i'' + F_i q_i' + Gamma_i = tau_i.

Source   "Coupled-Nonlinear Elastic Structure", Eqs (28)-(57), corrected: no equation of (28)-(51) is right as printed.
         The forms here were derived again from the energies; the tests hold their sum against automatic
         differentiation. Beyond the paper: gravity on the deflections, the payload's absolute rotation, hub inertias,
         friction and damping; any number of modes; and, with `tip_slope`, the change of coordinates
         theta2 -> theta2 + u1'(L1), which adds the reaction phi1' tau2 to link 1's elastic equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_instance
from pliant.plants.core.signals import OwnsArrays

from .two_link import TwoLinkArm

Array = np.ndarray


@dataclass(frozen=True)
class Terms(OwnsArrays):
    """The three parts of each equation, shape (n,): inertia J [kg m^2 or kg], rate factor F, the rest Gamma.

    `acceleration` (n,) and `rate` (n,) are those at which Gamma was evaluated; `applied` (n,) the generalised input.
    """

    J: Array
    F: Array
    Gamma: Array
    rate: Array
    acceleration: Array
    applied: Array

    @property
    def residual(self) -> Array:
        """J q'' + F q' + Gamma - tau, zero to rounding. (4,) or (nq,), torques [N m]."""
        return self.J * self.acceleration + self.F * self.rate + self.Gamma - self.applied


def paper_terms(arm: TwoLinkArm, x: Any, u: Any = None) -> Terms:
    """J, F and Gamma of every equation at state x (nx,) [rad, m, rad/s, m/s] and torques u (2,) [N m].

    Raises ValueError for what the paper's form does not hold: shortening, payload offset, a reduction stage.

    Example
    -------
    >>> arm = TwoLinkArm.textbook()
    >>> paper_terms(arm, np.zeros(arm.nx)).J.shape
    (6,)
    """
    require_instance("paper_terms.arm", arm, TwoLinkArm)
    for name, want in (("kinematics", "linear"), ("reduction", "full")):
        if getattr(arm, name) != want:
            raise ValueError(f"TwoLinkArm.{name} = {getattr(arm, name)!r} must be {want!r} for the paper's terms")
    if any(arm.payload.offset):
        raise ValueError(f"payload.offset = {arm.payload.offset} must be zero for the paper's terms")
    u = np.zeros(2) if u is None else require_finite("paper_terms.u", u, (2,))
    x = require_finite("paper_terms.x", x, (arm.nx,))
    n, n1 = len(arm.coordinates), arm.mode_counts[0]
    acceleration = arm.dynamics(x, u)[n:]
    q, v, a = x[:n].copy(), x[n:].copy(), acceleration.copy()
    slope = np.zeros(n)
    if arm.tip_slope:
        slope[2 : 2 + n1] = arm.links[0].basis.tip_slope / arm.link1.length
        for motion in (q, v, a):
            motion[1] += slope @ motion
    J, F, Gamma, coupling = _without_slope(arm, q, v, a)
    if arm.tip_slope:
        second = J[1] * a[1] + F[1] * v[1] + Gamma[1]  # the equation of link 2's absolute turn
        Gamma[1] += J[1] * (slope @ acceleration) + F[1] * (slope @ x[n:])
        own = slope**2 * J[1] + 2 * slope * coupling
        J += own
        Gamma += slope * second - own * acceleration
    Gamma += _losses(arm, x[n:])
    applied = np.zeros(n)
    applied[:2] = u
    return Terms(J, F, Gamma, x[n:], acceleration, applied)


def _losses(arm: TwoLinkArm, v: Array) -> Array:
    """Joint friction and structural damping."""
    n1 = arm.mode_counts[0]
    lost = np.zeros(len(v))
    lost[:2] = np.array(arm.joint_friction) * v[:2]
    for beam, link, part in (
        (arm.link1, arm.links[0], slice(2, 2 + n1)),
        (arm.link2, arm.links[1], slice(2 + n1, None)),
    ):
        lost[part] = beam.damping * beam.EI / beam.length**3 * link.basis.stiffness @ v[part]
    return lost


def _without_slope(arm: TwoLinkArm, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array, Array]:
    """Corrected (34)-(51), theta2 measured from link 1's root direction; the names are the paper's.

    Returns J, F, Gamma and row 2 of the mass matrix, link 1's columns only, each (n,).
    """
    n1 = arm.mode_counts[0]
    e1, e2 = slice(2, 2 + n1), slice(2 + n1, None)
    (q1, q2), (q1d, q2d), (q1dd, q2dd) = ((z[e1], z[e2]) for z in (q, v, a))
    th1, th2 = q[:2]
    th1d, th2d = v[:2]
    th1dd, th2dd = a[:2]
    L1, L2, m1, m2 = arm.link1.length, arm.link2.length, arm.link1.mass, arm.link2.mass
    mj, mp, Jp, g = arm.joint_mass, arm.payload.mass, arm.payload.inertia_z, arm.gravity
    b1, b2 = arm.links[0].basis, arm.links[1].basis
    phi1, phi2, phi2s = b1.tip, b2.tip, b2.tip_slope / L2
    nw1, nq1 = m1 * L1 * b1.moment, m1 * b1.first
    nw2, nq2 = m2 * L2 * b2.moment, m2 * b2.first
    K1 = arm.link1.EI / L1**3 * b1.stiffness
    K2 = arm.link2.EI / L2**3 * b2.stiffness
    M1, M2 = m1 * b1.mass, m2 * b2.mass

    gamma, eta, eps, delta = 2 * L1, mp * L2, m2 + mj + mp, mp  # (56)
    alpha = m2 * L2 + 2 * eta
    S1, S3, S7 = phi1 @ q1, phi1 @ q1d, phi1 @ q1dd  # (57)
    S2, S4, S8 = phi2 @ q2, phi2 @ q2d, phi2 @ q2dd
    S5, S6, S9 = nq2 @ q2, nq2 @ q2d, nq2 @ q2dd
    X, Xd, Xdd = S5 + delta * S2, S6 + delta * S4, S9 + delta * S8
    G1, G1d, G2, G2d = q1 @ M1 @ q1, 2 * q1 @ M1 @ q1d, q2 @ M2 @ q2, 2 * q2 @ M2 @ q2d
    A2 = m2 * L1 * L2 + 2 * mp * L1 * L2  # (52)-(55)
    A3 = m2 * L2**2 / 3 + mp * L2**2 + Jp + arm.hub_inertia[1]
    A4 = (m1 / 2 + m2 + mp) * L1 * g
    A5 = (m2 / 2 + mp) * L2 * g
    c1, s1, c2, s2 = np.cos(th1), np.sin(th1), np.cos(th2), np.sin(th2)
    c12, s12 = np.cos(th1 + th2), np.sin(th1 + th2)
    Om, Omd = th1d + th2d, th1dd + th2dd
    turned = Jp * phi2s  # the payload turns with the tip's slope as well as with both joints

    C1, D1 = alpha * S1 - gamma * X, A2 + 2 * S1 * X
    J1 = m1 * L1**2 / 3 + eps * L1**2 + arm.hub_inertia[0] + A3 + eps * S1**2 + G1 + delta * S2**2 + G2
    J1 += C1 * s2 + D1 * c2
    F1 = 2 * eps * S1 * S3 + G1d + 2 * delta * S2 * S4 + G2d
    F1 += (alpha * S3 - gamma * Xd - D1 * th2d) * s2 + (C1 * th2d + 2 * (S1 * Xd + S3 * X)) * c2
    J2 = A3 + delta * S2**2 + G2
    F2 = 2 * delta * S2 * S4 + G2d
    sag = g * X * s12  # gravity on the deflections
    Gam1 = J2 * th2dd + nw1 @ q1dd + (nw2 + turned) @ q2dd + eps * L1 * S7 + eta * S8 + F2 * th2d
    Gam1 += (A4 + mj * g * L1) * c1 + A5 * c12 - g * (nq1 @ q1 + eps * S1) * s1 - sag
    Gam1 += (C1 * th2dd / 2 - gamma * Xd * th2d - D1 * th2d**2 / 2 - X * S7 + S1 * Xdd) * s2
    Gam1 += (D1 * th2dd / 2 + C1 * th2d**2 / 2 + 2 * S1 * Xd * th2d + alpha * S7 / 2 + L1 * Xdd) * c2
    Gam2 = J2 * th1dd + F2 * th1d + (nw2 + turned) @ q2dd + eta * S8 + A5 * c12 - sag
    Gam2 += (C1 * th1dd / 2 + alpha * S3 * th1d + D1 * th1d**2 / 2 - X * S7) * s2
    Gam2 += (D1 * th1dd / 2 - C1 * th1d**2 / 2 + 2 * X * S3 * th1d + alpha * S7 / 2) * c2

    mass1 = M1 + eps * np.outer(phi1, phi1)
    J3 = np.diag(mass1)
    Gam3 = mass1 @ q1dd - J3 * q1dd + (nw1 + eps * L1 * phi1) * th1dd
    Gam3 += K1 @ q1 - th1d**2 * (M1 @ q1 + eps * phi1 * S1) + g * c1 * (nq1 + eps * phi1)
    Gam3 -= phi1 * (X * Omd + 2 * Xd * Om + alpha * Om**2 / 2) * s2
    Gam3 += phi1 * (alpha * Omd / 2 - X * Om**2 + Xdd) * c2

    ch = nq2 + delta * phi2
    mass2 = M2 + delta * np.outer(phi2, phi2) + Jp * np.outer(phi2s, phi2s)
    J5 = np.diag(mass2)
    Gam5 = mass2 @ q2dd - J5 * q2dd + (nw2 + eta * phi2 + turned) * Omd
    Gam5 += K2 @ q2 - Om**2 * (M2 @ q2 + delta * phi2 * S2) + g * c12 * ch
    Gam5 += ch * (S1 * th1dd + 2 * S3 * th1d + L1 * th1d**2) * s2
    Gam5 += ch * (L1 * th1dd + S7 - S1 * th1d**2) * c2

    J = np.concatenate([[J1, J2], J3, J5])
    F = np.concatenate([[F1, F2], np.zeros(len(J3) + len(J5))])
    coupling = np.zeros(len(J))
    coupling[e1] = phi1 * (alpha * c2 / 2 - X * s2)
    return J, F, np.concatenate([[Gam1, Gam2], Gam3, Gam5]), coupling

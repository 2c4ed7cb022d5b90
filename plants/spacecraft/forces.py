"""What a spacecraft's equations of motion lack at accelerations that are given, no mass matrix written out.

Speeds are what follows the coordinates in x: velocity in reference axes, body rates, hinge rates, eta rates, wheel
momenta. Every body's inertial force is M_A (J a + drift) in its own axes, brought to the unknowns by J^T. Without
translation the hub's mass centre moves so that no force is lacking, a_h = -r_h / m with the whole mass m.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.casadi_functions import entries
from pliant.plants.core.quaternions import matrix

from .declaration import SpacecraftDeclaration
from .equations import drift, frame_acceleration, hub_environment, hub_share, lacking, motion, restoring, wheel_rates


def balance(craft: SpacecraftDeclaration, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
    """Loads less inertial forces (m,) of the speeds at their rates a (m,): forces in reference axes, the rest in [N m]
    or, of modes, in [N].
    """
    at, first = craft.layout, craft.layout.velocity.start
    R = matrix(x[at.quaternion])
    place = R.T @ (a[:3] + frame_acceleration(craft, x)) if craft.translation else ca.SX.zeros(3)
    hub = ca.vertcat(place, a[at.omega.start - first : at.omega.stop - first])
    share, mass = hub_share(craft, x, u, w), craft.hub.mass
    found = share.M @ hub + share.r - hub_environment(craft, t, x)
    bodies = []
    for i, body in enumerate(craft.appendages):
        k = motion(craft, i, x)
        own = ca.vertcat(
            *(entries(a, slice(s.start - first, s.stop - first)) for s in (at.hinge_rates[i], at.mode_rates[i]))
        )
        force = lacking(craft, i, t, x, k, k.J @ ca.vertcat(hub, own) + drift(body, k))
        mass += k.inertia.mass
        found[:3] += k.C @ force[:3]
        bodies.append((k, force))
    free = -found[:3] / mass if not craft.translation else ca.SX.zeros(3)
    hinges, modes = [], []
    for i, (k, force) in enumerate(bodies):
        n = k.theta.shape[0]
        if not craft.translation:
            falls, inertia = k.C.T @ free, k.inertia
            force += ca.vertcat(inertia.mass * falls, ca.cross(inertia.S, falls), inertia.R.T @ falls)
        moved = k.J.T @ force
        found[3:] += moved[3:6]
        kept = moved[6:] + restoring(craft.appendages[i], k, entries(u, at.hinge_inputs[i]))
        hinges.append(entries(kept, slice(0, n)))
        modes.append(entries(kept, slice(n, kept.shape[0])))
    place = -R @ found[:3] if craft.translation else ca.SX(0, 1)
    wheels = wheel_rates(craft, x, u) - a[at.wheels.start - first :] if craft.hub.wheels else ca.SX(0, 1)
    return ca.vertcat(place, -found[3:], -ca.vertcat(*hinges), -ca.vertcat(*modes), wheels)

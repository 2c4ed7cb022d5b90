"""The spacecraft's equations as expressions, body by body.

Every appendage couples with the hub only, so that the mass matrix is a block arrow: the appendages' blocks are
eliminated and 6 equations of the hub remain.

Unknowns   [acceleration of the hub's mass centre in hub axes, d omega/dt, hinge accelerations, modal accelerations]
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from pliant.plants.core.casadi_functions import entries, last_call
from pliant.plants.core.quaternions import cross, matrix, rates
from pliant.plants.modal_data.deformed_body import Deformed
from pliant.plants.modal_data.inertial_forces import inertial_forces
from pliant.plants.spacecraft_parts.appendage import Appendage

from .block_arrow import Share, accelerations
from .declaration import SpacecraftDeclaration

NORM_PULL = 0.1  # [1/s], half the rate at which |quaternion|^2 returns to 1; no effect where it is 1


def hub_share(craft: SpacecraftDeclaration, x: ca.SX, u: ca.SX, w: ca.SX) -> Share:
    """The rigid hub with wheels, thrusters and the loads on it."""
    at, hub = craft.layout, craft.hub
    omega, wheels, R = x[at.omega], x[at.wheels], matrix(x[at.quaternion])
    load = hub.actuation(omega, wheels, u[at.hub_inputs]) + ca.vertcat(R.T @ w[:3], w[3:])
    return Share(ca.diagcat(hub.mass * ca.SX.eye(3), hub.tensor), hub.bias(omega, wheels) - load, [], None)


def hub_environment(craft: SpacecraftDeclaration, t: ca.SX, x: ca.SX) -> ca.SX:
    """Force and torque (6,) of the environment on the hub, in hub axes."""
    at, hub, outside = craft.layout, craft.hub, craft.environment
    R = matrix(x[at.quaternion])
    load = ca.vertcat(ca.SX.zeros(3), outside.residual_torque(R))
    if outside.orbit is not None:
        g, gradient = _gravity(craft, x, R)
        I = hub.tensor
        P = ca.trace(I) / 2 * ca.SX.eye(3) - I
        load += ca.vertcat(hub.mass * g, _axial(P @ gradient))
    if outside.sun is not None:
        sun = R.T @ outside.sun.at(t, outside.orbit)
        for surface in hub.surfaces:
            force = surface.force(sun, outside.sun.pressure)
            load += ca.vertcat(force, ca.cross(ca.vertcat(*surface.centre), force))
    return load


def _gravity(craft: SpacecraftDeclaration, x: ca.SX, R: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Gravity (3,) at the hub and its gradient (3, 3), in hub axes. A uniform part does not matter without
    translation.
    """
    position = x[craft.layout.position] if craft.translation else ca.SX.zeros(3)
    assert craft.environment.orbit is not None
    g, gradient = craft.environment.orbit.pull(position)
    return R.T @ g, R.T @ gradient @ R


def _axial(P: ca.SX) -> ca.SX:
    """int a x b dm (3,) from P = int a b^T dm."""
    return ca.vertcat(P[1, 2] - P[2, 1], P[2, 0] - P[0, 2], P[0, 1] - P[1, 0])


class Motion(NamedTuple):
    """What an appendage's equations are written in."""

    C: ca.SX  # appendage axes to hub axes
    G: ca.SX
    J: ca.SX  # (6 + n, 6 + nh + n): origin, axes and modes from the hub's and its own unknowns
    inertia: Deformed
    theta: ca.SX
    eta: ca.SX
    theta_rate: ca.SX
    eta_rate: ca.SX
    omega: ca.SX  # of the hub
    omega_A: ca.SX  # of the appendage, in its axes


def motion(craft: SpacecraftDeclaration, i: int, x: ca.SX) -> Motion:
    """Kinematics of appendage i."""
    at, body = craft.layout, craft.appendages[i]
    theta, eta, omega = x[at.hinges[i]], x[at.modes[i]], x[at.omega]
    theta_rate, eta_rate = x[at.hinge_rates[i]], x[at.mode_rates[i]]
    nh, n = theta.shape[0], eta.shape[0]
    C, G = body.turn(theta), body.hinge_rates(theta)
    b = cross(ca.vertcat(*body.position))
    J = ca.vertcat(
        ca.horzcat(C.T, -C.T @ b, ca.SX(3, nh + n)),
        ca.horzcat(ca.SX(3, 3), C.T, G, ca.SX(3, n)),
        ca.horzcat(ca.SX(n, 6 + nh), ca.SX.eye(n)),
    )
    stiffened = craft.kinematics == "stiffened"
    omega_A = C.T @ omega + G @ theta_rate
    inertia = Deformed.of(craft.nominal_data(i), eta, stiffened)
    return Motion(C, G, J, inertia, theta, eta, theta_rate, eta_rate, omega, omega_A)


def environment(craft: SpacecraftDeclaration, i: int, t: ca.SX, x: ca.SX, k: Motion) -> ca.SX:
    """Force, torque about the origin and modal forces (6 + n,) of the environment on appendage i, in its axes."""
    body, outside, inertia = craft.appendages[i], craft.environment, k.inertia
    n = k.eta.shape[0]
    load = ca.SX.zeros(6 + n)
    R = matrix(x[craft.layout.quaternion])
    if outside.orbit is not None:
        g, gradient = _gravity(craft, x, R)
        g, gradient = k.C.T @ (g + gradient @ ca.vertcat(*body.position)), k.C.T @ gradient @ k.C
        work = ca.dot(inertia.S, g) + ca.trace(gradient @ inertia.P) / 2
        force = inertia.mass * g + gradient @ inertia.S
        torque = ca.cross(inertia.S, g) + _axial(inertia.P @ gradient)
        load += ca.vertcat(force, torque, _gradient(work, k.eta))
    if outside.sun is not None and body.surface is not None:
        sun = k.C.T @ R.T @ outside.sun.at(t, outside.orbit)
        force = body.surface.force(sun, outside.sun.pressure)
        load += ca.vertcat(force, ca.cross(inertia.S, force) / inertia.mass, inertia.R.T @ force / inertia.mass)
    return load


def _gradient(work: ca.SX, eta: ca.SX) -> ca.SX:
    return ca.gradient(work, eta) if eta.shape[0] else ca.SX(0, 1)


def hinge_torque(body: Appendage, k: Motion, u: ca.SX) -> ca.SX:
    """Motor and damper torques (nh,); the spring's are added where it is not yet commanded."""
    damping = ca.vertcat(*body.hinge.damping) if body.hinge.n else ca.SX(0, 1)
    torque = -damping * k.theta_rate
    if body.hinge.drive == "torque":
        torque += u
    if body.hinge.drive == "angle":
        torque += ca.vertcat(*body.hinge.stiffness) * u
    return torque


def lacking(craft: SpacecraftDeclaration, i: int, t: ca.SX, x: ca.SX, k: Motion, a: ca.SX) -> ca.SX:
    """Inertial forces less the environment's loads (6 + n,) on appendage i at accelerations a (6 + n,), in its axes."""
    moving = (k.eta, k.eta_rate, a[6:], k.omega_A, a[:3], a[3:6])
    forces = inertial_forces(craft.nominal_data(i), *moving, craft.kinematics == "stiffened")
    return forces - environment(craft, i, t, x, k)


def drift(body: Appendage, k: Motion) -> ca.SX:
    """Accelerations (6 + n,) in the appendage's axes where its and the hub's unknowns are zero."""
    b = ca.vertcat(*body.position)
    found = ca.vertcat(k.C.T @ ca.cross(k.omega, ca.cross(k.omega, b)), ca.SX.zeros(3 + k.eta.shape[0]))
    if k.theta.shape[0]:
        found[3:6] = ca.jtimes(k.omega_A, k.theta, k.theta_rate)
    return found


def restoring(body: Appendage, k: Motion, u: ca.SX) -> ca.SX:
    """Of spring, damper and motor of the hinge and of strain (nh + n,): less the forces on its own unknowns."""
    found = ca.SX(0, 1)
    if k.theta.shape[0]:
        found = ca.vertcat(*body.hinge.stiffness) * k.theta - hinge_torque(body, k, u)
    return ca.vertcat(found, body.strain_force(k.eta, k.eta_rate)) if k.eta.shape[0] else found


def appendage_share(craft: SpacecraftDeclaration, i: int, t: ca.SX, x: ca.SX, u: ca.SX) -> Share:
    """Appendage i with its hinge, its strain and the loads on it."""
    at, body = craft.layout, craft.appendages[i]
    k, u = motion(craft, i, x), entries(u, at.hinge_inputs[i])
    r = k.J.T @ lacking(craft, i, t, x, k, drift(body, k))
    r[6:] += restoring(body, k, u)
    given = u if body.hinge.drive == "motion" else None
    return Share(k.J.T @ k.inertia.matrix @ k.J, r, at.unknowns(i), given)


@last_call
def shares(craft: SpacecraftDeclaration, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> list[Share]:
    """The hub's share, the environment included, then every appendage's."""
    hub = hub_share(craft, x, u, w)
    hub = hub._replace(r=hub.r - hub_environment(craft, t, x))
    return [hub, *(appendage_share(craft, i, t, x, u) for i in range(len(craft.appendages)))]


def coordinate_rates(craft: SpacecraftDeclaration, x: ca.SX) -> ca.SX:
    """Rates of position, quaternion, hinge angles and elastic coordinates: of what stands before the velocities."""
    at, orbit = craft.layout, craft.environment.orbit
    q, relative = x[at.quaternion], x[at.omega]
    if orbit is not None:
        relative = relative - matrix(q).T @ orbit.turning
    turn = rates(q) @ relative / 2 + NORM_PULL * (1 - ca.dot(q, q)) * q
    speeds = x[at.rates : at.rates + len(craft.coordinates)]
    return ca.vertcat(entries(x, at.velocity), turn, speeds)


def frame_acceleration(craft: SpacecraftDeclaration, x: ca.SX) -> ca.SX | float:
    """What the acceleration of the hub's mass centre has more (3,) than d(velocity)/dt, in reference axes that turn."""
    at, orbit = craft.layout, craft.environment.orbit
    if orbit is None:
        return 0.0
    turning = orbit.turning
    return 2 * ca.cross(turning, x[at.velocity]) + ca.cross(turning, ca.cross(turning, x[at.position]))


def wheel_rates(craft: SpacecraftDeclaration, x: ca.SX, u: ca.SX) -> ca.SX:
    """d(momentum)/dt of the wheels (nw,) [N m]."""
    at, hub = craft.layout, craft.hub
    return -hub.wheel_torques(x[at.omega], x[at.wheels], u[at.hub_inputs]) if hub.wheels else ca.SX(0, 1)


def rate_of(craft: SpacecraftDeclaration, x: ca.SX, u: ca.SX, a: ca.SX) -> ca.SX:
    """dx/dt (nx,) at the accelerations a (6 + n,)."""
    place = ca.SX(0, 1)
    if craft.translation:
        place = matrix(x[craft.layout.quaternion]) @ a[:3] - frame_acceleration(craft, x)
    return ca.vertcat(coordinate_rates(craft, x), place, a[3:], wheel_rates(craft, x, u))


def rate(craft: SpacecraftDeclaration, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX]:
    """dx/dt (nx,) and the smallest pivot of the mass matrix."""
    a, pivot = accelerations(shares(craft, t, x, u, w))
    return rate_of(craft, x, u, a), pivot

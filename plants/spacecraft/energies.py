"""Energy, momentum and power of a spacecraft as expressions."""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.casadi_functions import entries
from pliant.plants.core.quaternions import matrix

from .declaration import SpacecraftDeclaration
from .equations import Motion, environment, hinge_torque, hub_environment, motion, rate


def velocities(k: Motion, velocity: ca.SX) -> ca.SX:
    """Velocity of the origin, omega and modal rates (6 + n,) of an appendage in its axes; the hub's in hub axes."""
    return k.J @ ca.vertcat(velocity, k.omega, k.theta_rate, k.eta_rate)


def hub_velocity(craft: SpacecraftDeclaration, x: ca.SX, motions: list[Motion]) -> ca.SX:
    """Velocity (3,) of the hub's mass centre in hub axes; without translation that relative to the whole's mass
    centre, which the spacecraft's own motion gives.
    """
    if craft.translation:
        return matrix(x[craft.layout.quaternion]).T @ x[craft.layout.velocity]
    carried, mass = ca.SX.zeros(3), ca.SX(craft.hub.mass)
    for k in motions:
        carried += k.C @ (k.inertia.matrix[:3, :] @ velocities(k, ca.SX.zeros(3)))
        mass += k.inertia.mass
    return -carried / mass


def conserved(craft: SpacecraftDeclaration, x: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """(energy, linear momentum (3,), angular momentum (3,)), momenta in reference axes; see `FlexibleSpacecraft`."""
    at, hub = craft.layout, craft.hub
    R, omega, wheels = matrix(x[at.quaternion]), x[at.omega], x[at.wheels]
    motions = [motion(craft, i, x) for i in range(len(craft.appendages))]
    v = hub_velocity(craft, x, motions)
    E = hub.mass * ca.dot(v, v) / 2 + ca.dot(omega, hub.tensor @ omega) / 2
    E += sum((wheels[k] ** 2 / (2 * wheel.inertia) for k, wheel in enumerate(hub.wheels)), ca.SX(0))
    linear, angular = hub.mass * v, hub.momentum(omega, wheels)
    for body, k in zip(craft.appendages, motions):
        z = velocities(k, v)
        momenta = k.inertia.matrix @ z
        E += ca.dot(z, momenta) / 2 + body.strain_energy(k.eta)
        if body.hinge.n:
            E += ca.dot(ca.vertcat(*body.hinge.stiffness), k.theta**2) / 2
        p = k.C @ momenta[:3]
        linear += p
        angular += k.C @ momenta[3:6] + ca.cross(ca.vertcat(*body.position), p)
    linear, angular = R @ linear, R @ angular
    if craft.translation:
        angular += ca.cross(x[at.position], linear)
    return E, linear, angular


def power(craft: SpacecraftDeclaration, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(power put in by inputs and loads, power lost in dampers and bearings) [W]: dE/dt is their difference.

    What driven hinges and turning orbit axes put in is what the rate of the energy leaves.
    """
    at, hub = craft.layout, craft.hub
    R, omega, wheels = matrix(x[at.quaternion]), x[at.omega], x[at.wheels]
    motions = [motion(craft, i, x) for i in range(len(craft.appendages))]
    rubbed = sum((w.friction * w.speed(wheels[j], omega) ** 2 for j, w in enumerate(hub.wheels)), ca.SX(0))
    lost = rubbed
    for body, k in zip(craft.appendages, motions):
        if body.hinge.n:
            lost += ca.dot(ca.vertcat(*body.hinge.damping), k.theta_rate**2)
        if k.eta.shape[0]:
            lost += ca.dot(k.eta_rate, body.dissipation(k.eta.shape[0]) @ k.eta_rate)
    if craft.environment.orbit is not None or any(a.hinge.drive == "motion" for a in craft.appendages):
        return ca.jtimes(conserved(craft, x)[0], x, rate(craft, t, x, u, w)[0]) + lost, lost
    v, pushed = hub_velocity(craft, x, motions), u[at.hub_inputs]
    load = ca.vertcat(R.T @ w[:3], w[3:]) + hub_environment(craft, t, x) + hub.actuation(omega, wheels, pushed)
    put_in = ca.dot(load, ca.vertcat(v, omega))
    if hub.wheels:
        torques = hub.wheel_torques(omega, wheels, pushed)
        put_in += rubbed - sum((torques[j] * wheels[j] / w.inertia for j, w in enumerate(hub.wheels)), ca.SX(0))
    for i, (body, k) in enumerate(zip(craft.appendages, motions)):
        put_in += ca.dot(environment(craft, i, t, x, k), velocities(k, v))
        if body.hinge.n:
            damping = ca.vertcat(*body.hinge.damping) * k.theta_rate
            put_in += ca.dot(hinge_torque(body, k, entries(u, at.hinge_inputs[i])) + damping, k.theta_rate)
    return put_in, lost

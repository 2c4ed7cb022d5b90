"""The spacecraft's equations as expressions, body by body.

Every appendage couples with the hub only, so that the mass matrix is a block arrow: the appendages' blocks are
eliminated and 6 equations of the hub remain. The linearisation is of the residual r(x, u, a) = M a + bias - loads
at the accelerations a that solve r = 0: da/dx = -M^-1 dr/dx, with the same elimination.

Unknowns   [acceleration of the hub's mass centre in hub axes, d omega/dt, hinge accelerations, modal accelerations]
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.quaternions import cross, matrix, rates
from pliant.plants.dynamics.residual_jacobians import Differentiated
from pliant.plants.dynamics.symbolic_ldl import ldl, ldl_solve

from .appendage import Appendage, Inertia

if TYPE_CHECKING:
    from .plant import FlexibleSpacecraft

NORM_PULL = 0.1  # [1/s], half the rate at which |quaternion|^2 returns to 1; no effect where it is 1


@dataclass(frozen=True)
class Layout:
    """Slices of x and u; `hinges`, `modes` and so on one for each appendage."""

    position: slice
    quaternion: slice
    hinges: tuple[slice, ...]
    modes: tuple[slice, ...]
    velocity: slice
    omega: slice
    hinge_rates: tuple[slice, ...]
    mode_rates: tuple[slice, ...]
    wheels: slice
    hub_inputs: slice
    hinge_inputs: tuple[slice, ...]

    @classmethod
    def of(cls, craft: FlexibleSpacecraft) -> Layout:
        """The layout of this spacecraft's states and inputs."""
        place = 3 if craft.translation else 0
        angles, modes = [a.hinge.n for a in craft.appendages], list(craft.mode_counts)
        moved = [0 if a.hinge.drive == "free" else a.hinge.n for a in craft.appendages]
        sizes = [place, 4, *angles, *modes, place, 3, *angles, *modes, len(craft.hub.wheels)]
        ends = np.cumsum([0, *sizes])
        parts = [slice(int(a), int(b)) for a, b in itertools.pairwise(ends)]
        m = len(angles)
        hub = craft.hub.inputs
        starts = hub + np.cumsum([0, *moved])
        return cls(
            parts[0],
            parts[1],
            tuple(parts[2 : 2 + m]),
            tuple(parts[2 + m : 2 + 2 * m]),
            parts[2 + 2 * m],
            parts[3 + 2 * m],
            tuple(parts[4 + 2 * m : 4 + 3 * m]),
            tuple(parts[4 + 3 * m : 4 + 4 * m]),
            parts[-1],
            slice(0, hub),
            tuple(slice(int(a), int(b)) for a, b in itertools.pairwise(starts)),
        )

    def unknowns(self, i: int) -> list[int]:
        """Where appendage i's unknowns (hinges, modes) stand among all."""
        first = self.quaternion.stop - 6
        return [k - first for s in (self.hinges[i], self.modes[i]) for k in range(s.start, s.stop)]

    @property
    def rates(self) -> int:
        """Where the velocities of the unknowns after the hub's begin in x."""
        return self.omega.stop


class Share(NamedTuple):
    """One body's part of M a + r = 0 in the unknowns (hub 6, own n) and what it is driven at."""

    M: ca.SX
    r: ca.SX
    own: list[int]  # among all unknowns
    given: ca.SX | None  # hinge accelerations that are inputs


def hub_share(craft: FlexibleSpacecraft, x: ca.SX, u: ca.SX, w: ca.SX) -> Share:
    """The rigid hub with wheels, thrusters and the loads on it."""
    at, hub = craft.layout, craft.hub
    omega, wheels, R = x[at.omega], x[at.wheels], matrix(x[at.quaternion])
    load = hub.actuation(omega, wheels, u[at.hub_inputs]) + ca.vertcat(R.T @ w[:3], w[3:])
    return Share(ca.diagcat(hub.mass * ca.SX.eye(3), hub.tensor), hub.bias(omega, wheels) - load, [], None)


def hub_environment(craft: FlexibleSpacecraft, t: ca.SX, x: ca.SX) -> ca.SX:
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


def _gravity(craft: FlexibleSpacecraft, x: ca.SX, R: ca.SX) -> tuple[ca.SX, ca.SX]:
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
    inertia: Inertia
    theta: ca.SX
    eta: ca.SX
    theta_rate: ca.SX
    eta_rate: ca.SX
    omega: ca.SX  # of the hub
    omega_A: ca.SX  # of the appendage, in its axes


def motion(craft: FlexibleSpacecraft, i: int, x: ca.SX) -> Motion:
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
    inertia = Inertia.of(craft.nominal_data(i), eta, stiffened)
    return Motion(C, G, J, inertia, theta, eta, theta_rate, eta_rate, omega, omega_A)


def environment(craft: FlexibleSpacecraft, i: int, t: ca.SX, x: ca.SX, k: Motion) -> ca.SX:
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


def appendage_share(craft: FlexibleSpacecraft, i: int, t: ca.SX, x: ca.SX, u: ca.SX) -> Share:
    """Appendage i with its hinge, its strain and the loads on it."""
    at, body = craft.layout, craft.appendages[i]
    k, u = motion(craft, i, x), u[at.hinge_inputs[i]]
    nh, inertia = k.theta.shape[0], k.inertia
    M_A = inertia.matrix
    b = ca.vertcat(*body.position)
    drift = ca.vertcat(k.C.T @ ca.cross(k.omega, ca.cross(k.omega, b)), ca.SX.zeros(3 + k.eta.shape[0]))
    if nh:
        drift[3:6] = ca.jtimes(k.omega_A, k.theta, k.theta_rate)
    r_A = M_A @ drift + inertia.bias(k.omega_A, k.eta, k.eta_rate) - environment(craft, i, t, x, k)
    r = k.J.T @ r_A
    if nh:
        spring = ca.vertcat(*body.hinge.stiffness) * k.theta
        r[6 : 6 + nh] += spring - hinge_torque(body, k, u)
    if k.eta.shape[0]:
        r[6 + nh :] += body.strain_force(k.eta, k.eta_rate)
    given = u if body.hinge.drive == "motion" else None
    return Share(k.J.T @ M_A @ k.J, r, at.unknowns(i), given)


def shares(craft: FlexibleSpacecraft, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> list[Share]:
    """The hub's share, the environment included, then every appendage's."""
    hub = hub_share(craft, x, u, w)
    hub = hub._replace(r=hub.r - hub_environment(craft, t, x))
    return [hub, *(appendage_share(craft, i, t, x, u) for i in range(len(craft.appendages)))]


class Eliminated(NamedTuple):
    """The block arrow with the appendages eliminated: W = M_ii^-1 M_ih and M_ii^-1 of each, S^-1 of the hub."""

    W: list[ca.SX]
    inverse: list[ca.SX]
    free: list[list[int]]  # of the appendage's own unknowns, those that are solved for
    hub: ca.SX
    pivots: list[ca.SX]  # all positive where M is definite


def _inverse(M: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
    n = M.shape[0]
    if not n:
        return ca.SX(0, 0), []
    L, d = ldl(M)
    return ca.horzcat(*[ldl_solve(L, d, ca.SX(ca.DM.eye(n)[:, k])) for k in range(n)]), d


def eliminate(parts: list[Share]) -> Eliminated:
    """Factor M of the shares."""
    hub, W, inverses, frees, pivots = parts[0].M, [], [], [], []
    for share in parts[1:]:
        n, driven = len(share.own), 0 if share.given is None else share.given.shape[0]
        free = [6 + k for k in range(driven, n)]
        hub = hub + share.M[:6, :6]
        inverse, d = _inverse(share.M[free, free])
        pivots += d
        gain = inverse @ share.M[free, :6]
        hub = hub - share.M[:6, free] @ gain
        W.append(gain)
        inverses.append(inverse)
        frees.append(free)
    inverse, d = _inverse(hub)
    return Eliminated(W, inverses, frees, inverse, pivots + d)


def solve(parts: list[Share], e: Eliminated, columns: list[ca.SX]) -> ca.SX:
    """M^-1 of minus the columns (6 + own, m) of every share, rows in the order of all unknowns.

    Driven rows come out as zero: their accelerations are moved into the columns by the caller.
    """
    total = columns[0]
    for W, free, r in zip(e.W, e.free, columns[1:]):
        total = total + r[:6, :] - W.T @ r[free, :]
    hub = -e.hub @ total
    out = ca.SX(6 + sum(len(s.own) for s in parts[1:]), total.shape[1])
    out[:6, :] = hub
    for share, W, inverse, free, r in zip(parts[1:], e.W, e.inverse, e.free, columns[1:]):
        rows = [share.own[k - 6] for k in free]
        if rows:
            out[rows, :] = -inverse @ r[free, :] - W @ hub
    return out


def accelerations(parts: list[Share]) -> tuple[ca.SX, ca.SX]:
    """All unknowns that make the residual zero, driven ones as given, and the smallest pivot of M."""
    columns = []
    for share in parts:
        r = share.r
        if share.given is not None:
            r = r + share.M[:, 6 : 6 + share.given.shape[0]] @ share.given
        columns.append(r)
    e = eliminate(parts)
    a = ca.densify(solve(parts, e, columns))
    for share in parts[1:]:
        if share.given is not None:
            a[share.own[: share.given.shape[0]]] = share.given
    return a, ca.mmin(ca.vertcat(*e.pivots))


def rate_of(craft: FlexibleSpacecraft, x: ca.SX, u: ca.SX, a: ca.SX) -> ca.SX:
    """dx/dt (nx,) at the accelerations a (6 + n,)."""
    at, orbit = craft.layout, craft.environment.orbit
    q, omega = x[at.quaternion], x[at.omega]
    R = matrix(q)
    relative, moving = omega, R @ a[:3]
    if orbit is not None:
        turning = orbit.turning
        relative = omega - R.T @ turning
        if craft.translation:
            position, velocity = x[at.position], x[at.velocity]
            moving -= 2 * ca.cross(turning, velocity) + ca.cross(turning, ca.cross(turning, position))
    turn = rates(q) @ relative / 2 + NORM_PULL * (1 - ca.dot(q, q)) * q
    wheels = craft.hub.wheel_torques(omega, x[at.wheels], u[at.hub_inputs]) if craft.hub.wheels else ca.SX(0, 1)
    place = (x[at.velocity], moving) if craft.translation else (ca.SX(0, 1), ca.SX(0, 1))
    speeds = x[at.rates : at.rates + a.shape[0] - 6]
    return ca.vertcat(place[0], turn, speeds, place[1], a[3:], -wheels)


def rate(craft: FlexibleSpacecraft, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX]:
    """dx/dt (nx,) and the smallest pivot of the mass matrix."""
    a, pivot = accelerations(shares(craft, t, x, u, w))
    return rate_of(craft, x, u, a), pivot


def differentiated(craft: FlexibleSpacecraft) -> Differentiated:
    """The equations of all bodies at accelerations held: only the blocks that each can depend on."""
    t, x, u, w, _ = craft.symbols
    own = craft.symbolic
    parts = shares(own, t, x, u, w)
    solved, _ = accelerations(parts)
    a = ca.SX.sym("a", solved.shape[0])
    z = ca.vertcat(x, u, w)
    columns = []
    for k, share in enumerate(parts):
        mine = ca.vertcat(a[:6], a[share.own])
        columns.append(_sparse_jacobian(share.M @ mine + share.r, z, craft.layout, k - 1, craft.nx, craft.nu))
        if share.given is not None:  # a driven acceleration is its input
            n = share.given.shape[0]
            first = craft.nx + craft.layout.hinge_inputs[k - 1].start
            columns[-1][:, first : first + n] += share.M[:, 6 : 6 + n]
    da = solve(parts, eliminate(parts), columns)
    for k, share in enumerate(parts[1:]):
        if share.given is not None:
            for j in range(share.given.shape[0]):
                da[share.own[j], craft.nx + craft.layout.hinge_inputs[k].start + j] = 1
    return Differentiated(a, rate_of(own, x, u, a), da, solved)


def _sparse_jacobian(r: ca.SX, z: ca.SX, at: Layout, i: int, nx: int, nu: int) -> ca.SX:
    """dr/dz of one body's residual, differentiated by the columns that it can depend on."""
    places = [at.position, at.quaternion, at.velocity, at.omega, at.wheels]
    shifts = [0] * len(places)
    if i >= 0:
        places += [at.hinges[i], at.modes[i], at.hinge_rates[i], at.mode_rates[i], at.hinge_inputs[i]]
        shifts += [0, 0, 0, 0, nx]
    else:
        places += [at.hub_inputs, slice(0, 6)]
        shifts += [nx, nx + nu]
    at_columns = [k + shift for s, shift in zip(places, shifts) for k in range(s.start, s.stop)]
    J = ca.SX(r.shape[0], z.shape[0])
    J[:, at_columns] = ca.jacobian(r, z[at_columns])
    return J


def residual_function(craft: FlexibleSpacecraft) -> NumericFunction:
    """(t, x, u, w, p, a) -> (M a + r (6 + n,), M (6 + n, 6 + n)); driven hinges count as free."""
    t, x, u, w, p = craft.symbols
    parts = shares(craft.symbolic, t, x, u, w)
    count = 6 + sum(len(s.own) for s in parts[1:])
    a, M, r = ca.SX.sym("a", count), ca.SX(count, count), ca.SX.zeros(count)
    for share in parts:
        rows = [*range(6), *share.own]
        M[rows, rows] += share.M
        r[rows] += share.r
    return function("residual", [t, x, u, w, p, a], [M @ a + r, M])


def velocities(k: Motion, velocity: ca.SX) -> ca.SX:
    """Velocity of the origin, omega and modal rates (6 + n,) of an appendage in its axes; the hub's in hub axes."""
    return k.J @ ca.vertcat(velocity, k.omega, k.theta_rate, k.eta_rate)


def hub_velocity(craft: FlexibleSpacecraft, x: ca.SX, motions: list[Motion]) -> ca.SX:
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


def conserved(craft: FlexibleSpacecraft, x: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
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


def power(craft: FlexibleSpacecraft, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX]:
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
            put_in += ca.dot(hinge_torque(body, k, u[at.hinge_inputs[i]]) + damping, k.theta_rate)
    return put_in, lost


def outline(craft: FlexibleSpacecraft, x: np.ndarray) -> list[np.ndarray]:
    """Lines (m, 3) [m] of the appendages in reference axes."""
    at, lines = craft.layout, []
    R = craft.turn(x)
    origin = x[at.position] if craft.translation else np.zeros(3)
    for i, body in enumerate(craft.appendages):
        C = np.array(ca.DM(ca.densify(ca.evalf(body.turn(ca.SX(ca.DM(x[at.hinges[i]])))))))
        eta, data = x[at.modes[i]], body.data
        bent = data.outline + np.einsum("k,kpi->pi", eta, data.outline_shapes[: len(eta)])
        lines.append(origin + (np.asarray(body.position, dtype=float) + bent @ C.T) @ R.T)
    return lines

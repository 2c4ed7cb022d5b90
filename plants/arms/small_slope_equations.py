"""M a = r of the arms with small slopes, from each link's inertia: what the energies give, in half the operations.

Each link stands in its own (phi, q), phi the angle of its root against the x axis, and its vectors in the axes of that
root. Weight is an acceleration of the base. A link passes on to the one before its mass and mass moment, on which the
acceleration of its root acts. For two links y = (q2, phi2, q1, theta1) is solved for, in which no part is a sum of two,
and theta2 = phi2 - theta1 - the slope of link 1's tip.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.exact_rotations.strain_link import StrainLink

from .exact_rotation_equations import Equations
from .single_link_declaration import SingleLinkDeclaration
from .small_slope_links import SmallSlopeLink, column
from .two_link_declaration import TwoLinkDeclaration

Pair = tuple[ca.SX, ca.SX]


def of_small_slopes(link: ElasticLink) -> bool:
    """Whether the link's energies are those of `beams.elastic_link`."""
    return not isinstance(link, StrainLink)


def _turned(c: ca.SX, s: ca.SX, a: Pair) -> Pair:
    """A vector in axes that stand further by the angle of this cosine and sine."""
    return c * a[0] + s * a[1], c * a[1] - s * a[0]


def of_single_link(arm: SingleLinkDeclaration, x: ca.SX, u: ca.SX, w: ca.SX, carried: bool) -> Equations:
    """(M, r, T, V) in the clamped frame; `carried`: the payload's offset is not zero."""
    n = len(arm.coordinates)
    q, v = x[:n], x[n:]
    bare = SmallSlopeLink.of(arm.elastic, v[0], q[1:], v[1:], arm.hub_radius)
    link, moment = bare.loaded(arm.payload, carried)
    c, s, g = ca.cos(q[0]), ca.sin(q[0]), arm.gravity
    M = link.inertia
    M[0, 0] += arm.hub_inertia
    r = bare.tip().work(_turned(c, s, (w[0], w[1]))) - link.force - moment.work((g * s, g * c))
    driving = (u[0] if arm.drive == "torque" else 0) - arm.hub_friction * v[0]
    r = r + ca.vertcat(driving, -link.elastic_force())
    return M, r, ca.bilin(M, v, v) / 2, arm.potential_energy(q)


def absolute(arm: TwoLinkDeclaration) -> ca.SX:
    """B (n, n) of y = B q, y = (q2, phi2, q1, theta1)."""
    (n1, n2), n = arm.mode_counts, len(arm.coordinates)
    B = ca.SX(n, n)
    for i in range(n2):
        B[i, 2 + n1 + i] = 1
    B[n2, 0] = B[n2, 1] = B[n - 1, 0] = 1
    for i in range(n1):
        B[n2 + 1 + i, 2 + i] = 1
    if arm.tip_slope and n1:
        B[n2, 2 : 2 + n1] = _slope(arm).T
    return B


def relative(arm: TwoLinkDeclaration, y: ca.SX) -> ca.SX:
    """q (n,) of y = B q."""
    n1, n2 = arm.mode_counts
    bent, turned, first = y[n2 + 1 : n2 + 1 + n1], y[n2], y[n2 + 1 + n1]
    turn = arm.links[0].slope(bent) if arm.tip_slope else 0
    return ca.vertcat(first, turned - first - turn, bent, y[:n2])


def _slope(arm: TwoLinkDeclaration) -> ca.SX:
    """Turn of link 1's tip, times q1 (n1,)."""
    link = arm.links[0]
    rows = column(link.basis.tip_slope) / link.beam.length
    return ca.SX(rows) if arm.tip_slope else ca.SX.zeros(link.basis.n, 1)


def in_absolute_angles(arm: TwoLinkDeclaration, x: ca.SX, u: ca.SX, w: ca.SX, carried: bool) -> Pair:
    """(M, r) of M y'' = r, y = (q2, phi2, q1, theta1); `carried`: the payload's offset is not zero."""
    n, n1 = len(arm.coordinates), arm.mode_counts[0]
    q, v, (link1, link2) = x[:n], x[n:], arm.links
    slope, q1, v1, g = _slope(arm), ca.reshape(q[2 : 2 + n1], n1, 1), ca.reshape(v[2 : 2 + n1], n1, 1), arm.gravity
    turn, turn_rate = q[1] + ca.dot(slope, q1), v[1] + ca.dot(slope, v1)
    near = SmallSlopeLink.of(link1, v[0], q1, v1)
    bare = SmallSlopeLink.of(link2, v[0] + turn_rate, q[2 + n1 :], v[2 + n1 :])
    far, moment = bare.loaded(arm.payload, carried)
    joint, beyond = near.tip(), arm.joint_mass + link2.beam.mass + arm.payload.mass
    near = near.carrying(beyond, joint, moving=False)

    c1, s1, c, s = ca.cos(q[0]), ca.sin(q[0]), ca.cos(turn), ca.sin(turn)
    lifted = g * s1, g * c1  # in the axes of link 1, as all accelerations and forces below
    root = joint.bias[0] + lifted[0], joint.bias[1] + lifted[1]
    pushed = _turned(c1, s1, (w[0], w[1]))
    held = _turned(c, -s, moment.bias)
    passed = pushed[0] - held[0] - beyond * root[0], pushed[1] - held[1] - beyond * root[1]
    torque = u[1] - arm.joint_friction[1] * v[1]

    r1 = joint.work(passed) - near.force - near.mass_moment().work(lifted)
    r1 = r1 + ca.vertcat(u[0] - arm.joint_friction[0] * v[0] - torque, -near.elastic_force() - slope * torque)
    r2 = bare.tip().work(_turned(c, s, pushed)) - far.force - moment.work(_turned(c, s, root))
    r2 = r2 + ca.vertcat(torque, -far.elastic_force())

    J = joint.jacobian
    across = moment.jacobian.T @ ca.vertcat(c * J[0, :] + s * J[1, :], c * J[1, :] - s * J[0, :])  # (far, near)
    M1, M2 = near.inertia, far.inertia
    M1[0, 0] += arm.hub_inertia[0]
    M2[0, 0] += arm.hub_inertia[1]
    first, second = [*range(1, 1 + n1), 0], [*range(1, far.q.shape[0] + 1), 0]
    M = ca.blockcat([[M2[second, second], across[second, first]], [across[second, first].T, M1[first, first]]])
    return ca.densify(M), ca.densify(ca.vertcat(r2[second], r1[first]))


def of_two_links(arm: TwoLinkDeclaration, x: ca.SX, u: ca.SX, w: ca.SX, carried: bool) -> Equations:
    """(M, r, T, V) of the whole arm in its own coordinates."""
    n, B = len(arm.coordinates), absolute(arm)
    M, r = in_absolute_angles(arm, x, u, w, carried)
    M = B.T @ M @ B
    return M, B.T @ r, ca.bilin(M, x[n:], x[n:]) / 2, arm.potential_energy(x[:n])

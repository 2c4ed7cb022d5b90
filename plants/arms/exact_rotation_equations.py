"""M a = r of the arms with exact rotations, from each link's inertia: what the energies give, in fewer operations.

A link passes on to the one before what it carries: its mass and its first moment, on which the root's acceleration and
weight act. Two links stand in y = (theta1, q1, turn, q2), `turn` that of link 2's root against the x axis, constant
combinations of the coordinates.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.parameters import is_symbolic
from pliant.plants.exact_rotations.moving_link import MovingLink
from pliant.plants.exact_rotations.strain_link import StrainLink

from .single_link_declaration import SingleLinkDeclaration
from .two_link_declaration import TwoLinkDeclaration

Equations = tuple[ca.SX, ca.SX, ca.SX, ca.SX]


def written_out(link: object) -> bool:
    """Whether the link's inertia is written out: exact rotations without shear."""
    return isinstance(link, StrainLink) and link.basis.shear is None


def of_single_link(arm: SingleLinkDeclaration, x: ca.SX, u: ca.SX, w: ca.SX, carried: bool) -> Equations:
    """(M, r, T, V) in the clamped frame; `carried`: the payload's offset is not zero."""
    n = len(arm.coordinates)
    q, v, link = x[:n], x[n:], arm.elastic
    assert isinstance(link, StrainLink)
    own = MovingLink.of(link, q[0], v[0], q[1:], v[1:])
    own = own.loaded(link, arm.payload, q[0] + link.slope(q[1:]), v[0] + link.slope(v[1:]), carried)
    weight = ca.vertcat(0.0, arm.gravity)
    M, r = own.M, -own.force - own.moment.jacobian.T @ weight
    tip = own.tip.jacobian
    if is_symbolic(arm.hub_radius) or arm.hub_radius != 0.0:
        c, s = ca.cos(q[0]), ca.sin(q[0])
        root = ca.horzcat(arm.hub_radius * ca.vertcat(-s, c), ca.SX(2, n - 1))
        across = root.T @ own.moment.jacobian
        M = M + across + across.T
        M[0, 0] += own.mass * arm.hub_radius**2
        inward = -arm.hub_radius * v[0] ** 2 * ca.vertcat(c, s)
        r = r - own.moment.jacobian.T @ inward - root.T @ (own.moment.bias + own.mass * weight)
        tip = tip + root
    M[0, 0] += arm.hub_inertia
    if arm.drive == "torque":
        r[0] += u[0]
    return _completed(arm, q, v, M, r + tip.T @ w)


def of_two_links(arm: TwoLinkDeclaration, x: ca.SX, u: ca.SX, w: ca.SX, carried: bool) -> Equations:
    """(M, r, T, V) of the whole arm; `carried`: the payload's offset is not zero."""
    n, n1 = len(arm.coordinates), arm.mode_counts[0]
    q, v, (link1, link2) = x[:n], x[n:], arm.links
    assert isinstance(link1, StrainLink) and isinstance(link2, StrainLink)
    B = ca.SX(n, n)  # y = B q
    B[0, 0] = B[1 + n1, 0] = B[1 + n1, 1] = 1
    for i in range(n1):
        B[1 + i, 2 + i] = 1
        if arm.tip_slope:
            B[1 + n1, 2 + i] = link1.basis.tip_slope[i] / link1.beam.length
    for i in range(2 + n1, n):
        B[i, i] = 1
    y, rate, second = B @ q, B @ v, slice(2 + n1, None)
    turned, turning = y[1 + n1] + link2.slope(y[second]), rate[1 + n1] + link2.slope(rate[second])
    far = MovingLink.of(link2, y[1 + n1], rate[1 + n1], y[second], rate[second])
    far = far.loaded(link2, arm.payload, turned, turning, carried)
    near = MovingLink.of(link1, y[0], rate[0], y[1 : 1 + n1], rate[1 : 1 + n1])
    near = near.carrying(arm.joint_mass + far.mass, near.tip)
    weight = ca.vertcat(0.0, arm.gravity)
    across = near.tip.jacobian.T @ far.moment.jacobian
    M = ca.blockcat([[near.M, across], [across.T, far.M]])
    M[0, 0] += arm.hub_inertia[0]
    M[1 + n1, 1 + n1] += arm.hub_inertia[1]
    r = ca.vertcat(
        near.tip.jacobian.T @ (w - far.moment.bias) - near.force - near.moment.jacobian.T @ weight,
        far.tip.jacobian.T @ w - far.force - far.moment.jacobian.T @ (near.tip.bias + weight),
    )
    r = B.T @ r
    r[:2] += u
    return _completed(arm, q, v, B.T @ M @ B, r)


def _completed(arm: SingleLinkDeclaration | TwoLinkDeclaration, q: ca.SX, v: ca.SX, M: ca.SX, r: ca.SX) -> Equations:
    """With elastic forces and losses."""
    links = (arm.elastic,) if isinstance(arm, SingleLinkDeclaration) else arm.links
    start = q.shape[0] - sum(link.basis.n for link in links)
    strain = ca.SX(0)
    for link in links:
        strain += link.strain_energy(q[start : start + link.basis.n])
        start += link.basis.n
    r = r - ca.gradient(strain, q) - ca.gradient(arm.dissipation(q, v), v)
    return M, r, ca.bilin(M, v, v) / 2, arm.potential_energy(q)

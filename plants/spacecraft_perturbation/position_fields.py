"""Position fields of the bodies of a spacecraft along a rigid nominal, with their derivatives; see `perturbation`.

V z is the position of a point in inertial axes, z = (1, r, phi_1 .. phi_n). V is a product of rotations, each a
truncated Taylor series in time (`Jet`), so that products give its time derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.quaternions import matrix_of, skew
from pliant.plants.core.signals import names, read_only, read_only_times
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.linearisation import nominal_accelerations
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

Array = np.ndarray
E3 = np.eye(3)


class Jet(NamedTuple):
    """A matrix and its first two time derivatives, each (nt, a, b)."""

    value: Array
    d: Array
    dd: Array

    @classmethod
    def constant(cls, value: Array) -> Jet:
        """A constant matrix (a, b)."""
        value = np.asarray(value, dtype=float)[None]
        return cls(value, np.zeros_like(value), np.zeros_like(value))

    def __matmul__(self, other: Jet) -> Jet:
        return Jet(
            self.value @ other.value,
            self.d @ other.value + self.value @ other.d,
            self.dd @ other.value + 2 * self.d @ other.d + self.value @ other.dd,
        )

    def plus(self, other: Jet) -> Jet:
        """The sum."""
        return Jet(*(a + b for a, b in zip(self, other)))


@dataclass(frozen=True, eq=False)
class RigidNominal:
    """What a rigid program supplies at times t (nt,): the hub's acceleration, attitude and rates, and the hinge
    angles of each appendage with two derivatives. Elastic coordinates are zero. Arrays are write-protected copies.
    """

    t: Array  # (nt,) [s]
    quaternion: Array = field(repr=False)  # (nt, 4), hub axes to inertial axes, scalar first
    omega: Array = field(repr=False)  # (nt, 3) [rad/s], hub axes
    alpha: Array = field(repr=False)  # (nt, 3) [rad/s^2], d omega/dt in hub axes
    acceleration: Array = field(repr=False)  # (nt, 3) [m/s^2] of the hub's mass centre, inertial axes
    angles: tuple[Array, ...] = field(default=(), repr=False)  # (nt, nh) [rad] for each appendage
    angle_rates: tuple[Array, ...] = field(default=(), repr=False)
    angle_accelerations: tuple[Array, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "t", read_only_times("RigidNominal.t", self.t, fewest=1))
        nt = len(self.t)
        for name, width in (("quaternion", 4), ("omega", 3), ("alpha", 3), ("acceleration", 3)):
            object.__setattr__(self, name, read_only(f"RigidNominal.{name}", getattr(self, name), (nt, width)))
        norm = np.linalg.norm(self.quaternion, axis=1)
        if np.abs(norm - 1).max() > 1e-6:
            raise ValueError(f"RigidNominal.quaternion has norm {norm[np.argmax(np.abs(norm - 1))]:.6g}, must be 1")
        for name in ("angles", "angle_rates", "angle_accelerations"):
            given = tuple(read_only(f"RigidNominal.{name}", a, (nt, -1)) for a in getattr(self, name))
            object.__setattr__(self, name, given)

    @classmethod
    def of(cls, craft: FlexibleSpacecraft, trajectory: Any) -> RigidNominal:
        """From a trajectory of this spacecraft's states; its elastic coordinates must be zero."""
        at, x, dx = craft.layout, trajectory.x, trajectory.derivative()
        for s in (*at.modes, *at.mode_rates):
            if np.abs(x[:, s]).max(initial=0.0) > 0:
                raise ValueError(f"nominal {names(craft.states[s])} must be zero: the nominal is a rigid motion")
        if craft.translation:
            moving = dx[:, at.velocity]
        else:  # the hub moves as the forces on the whole ask
            own = nominal_accelerations(craft, trajectory, None)[:, :3]
            moving = np.einsum("tij,tj->ti", matrix_of(x[:, at.quaternion]), own)
        hinges = [(x[:, s], x[:, r], dx[:, r]) for s, r in zip(at.hinges, at.hinge_rates)]
        angles, rates, accelerations = zip(*hinges) if hinges else ((), (), ())
        return cls(
            trajectory.t,
            x[:, at.quaternion],
            x[:, at.omega],
            dx[:, at.omega],
            moving,
            tuple(angles),
            tuple(rates),
            tuple(accelerations),
        )


class Body(NamedTuple):
    """A body's field and its derivatives with respect to its unknowns."""

    V: Jet  # (nt, 3, m)
    J: list[Jet]
    second: dict[tuple[int, int], Array]  # d2V/dx_a dx_b (nt, 3, m), a <= b
    data: ModalData | None
    Pi: Array
    unknowns: list[int]  # of the body among all


def states_of(craft: FlexibleSpacecraft, nominal: RigidNominal) -> Array:
    """The plant's states (nt, nx) on a nominal, place and velocity zero: no range of its kinematics has them."""
    at, x = craft.layout, np.zeros((len(nominal.t), craft.nx))
    x[:, at.quaternion], x[:, at.omega] = nominal.quaternion, nominal.omega
    for angles, rates, here, there in zip(nominal.angles, nominal.angle_rates, at.hinges, at.hinge_rates):
        x[:, here], x[:, there] = angles, rates
    return x


def attitude(nominal: RigidNominal) -> Jet:
    R = matrix_of(nominal.quaternion)
    w, dw = skew(nominal.omega), skew(nominal.alpha)
    return Jet(R, R @ w, R @ (dw + w @ w))


def turning(axis: Any, angle: Array, rate: Array, acceleration: Array) -> Jet:
    """Rotation about a constant axis (3,) by an angle (nt,) [rad] with its derivatives."""
    K = skew(axis)
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    v, a = rate[:, None, None], acceleration[:, None, None]
    first, second = c * K + s * (K @ K), -s * K + c * (K @ K)
    return Jet(E3 + s * K + (1 - c) * (K @ K), first * v, second * v**2 + first * a)


def _times(jet: Jet, right: Array) -> Jet:
    return jet @ Jet.constant(right)


def _product(factors: Sequence[Jet]) -> Jet:
    out = factors[0]
    for factor in factors[1:]:
        out = out @ factor
    return out


def small(k: int, l: int | None = None) -> Array:
    """d/dq_k of exp(q~) at zero, or d2/dq_k dq_l: the symmetrised double cross product."""
    a = skew(E3[k])
    return a if l is None else (a @ skew(E3[l]) + skew(E3[l]) @ a) / 2


def hub_field(craft: FlexibleSpacecraft, nominal: RigidNominal, R: Jet, q: list[int], p: list[int]) -> Body:
    """The rigid hub: z = (1, r)."""
    I = np.array(craft.hub.inertia, dtype=float)
    Pi = np.zeros((4, 4))
    Pi[0, 0], Pi[1:, 1:] = craft.hub.mass, np.trace(I) / 2 * E3 - I
    placed = np.zeros((len(nominal.t), 3, 4))
    placed[:, :, 0] = nominal.acceleration
    zero = np.zeros_like(placed)
    wide = np.zeros((3, 4))
    wide[:, 1:] = E3
    V = Jet(zero, zero, placed).plus(_times(R, wide))
    J = [_times(R, small(k) @ wide) for k in range(3)]
    J += [Jet.constant(np.outer(E3[k], [1.0, 0, 0, 0])) for k in range(3)]
    second = {(k, l): R.value @ small(k, l) @ wide for k in range(3) for l in range(k, 3)}
    return Body(V, J, second, None, Pi, q + p)


def appendage_field(
    craft: FlexibleSpacecraft, i: int, nominal: RigidNominal, R: Jet, own: list[int], qp: list[int]
) -> Body:
    """Appendage i: unknowns [hinges, modes, q, p]."""
    body, n = craft.appendages[i], craft.mode_counts[i]
    data, nh, b = body.data.keep(range(n)), body.hinge.n, np.asarray(body.position, dtype=float)
    m, C0 = 4 + 3 * n, Jet.constant(np.array(body.orientation))
    if nh:
        motion = (nominal.angles[i], nominal.angle_rates[i], nominal.angle_accelerations[i])
        turns = [turning(h, *(a[:, j] for a in motion)) for j, h in enumerate(body.hinge.axes)]
    else:
        turns = []
    crosses = [Jet.constant(skew(h)) for h in body.hinge.axes]

    def C(*at: int) -> Jet:
        """C with the derivative taken once for every hinge angle in `at`."""
        factors = [C0]
        for j, turn in enumerate(turns):
            factors += [crosses[j]] * at.count(j) + [turn]
        return _product(factors)

    origin, wide = np.zeros((3, m)), np.zeros((3, m))
    origin[:, 0], wide[:, 1:4] = b, E3
    phi = []
    for k in range(n):
        column = np.zeros((3, m))
        column[:, 4 + 3 * k : 7 + 3 * k] = E3
        phi.append(column)
    inner = Jet.constant(origin).plus(_times(C(), wide))  # in hub axes
    zero = np.zeros((len(nominal.t), 3, m))
    moved = zero.copy()
    moved[:, :, 0] = nominal.acceleration
    V = Jet(zero, zero, moved).plus(R @ inner)
    by_hinge = [_times(C(j), wide) for j in range(nh)]
    by_mode = [_times(C(), phi[k]) for k in range(n)]
    turned = [Jet.constant(small(k)) for k in range(3)]
    J = [R @ d for d in by_hinge + by_mode] + [R @ turned[k] @ inner for k in range(3)]
    J += [Jet.constant(np.outer(E3[k], np.eye(m)[0])) for k in range(3)]
    second, Rv, first = {}, R.value, nh + n
    for j in range(nh):
        for l in range(j, nh):
            second[j, l] = Rv @ _times(C(j, l), wide).value
        for k in range(n):
            second[j, nh + k] = Rv @ _times(C(j), phi[k]).value
    for a, d in enumerate(by_hinge + by_mode):
        for k in range(3):
            second[a, first + k] = Rv @ small(k) @ d.value
    for k in range(3):
        for l in range(k, 3):
            second[first + k, first + l] = Rv @ small(k, l) @ inner.value
    return Body(V, J, second, data, data.pi, own + qp)


def assemble(bodies: list[Body], nt: int, n: int) -> tuple[Array, Array, Array, Array]:
    """A, B, C (nt, n, n) and Q (nt, n) of the inertia of the bodies."""
    A, B, C, Q = np.zeros((nt, n, n)), np.zeros((nt, n, n)), np.zeros((nt, n, n)), np.zeros((nt, n))
    for body in bodies:
        shape = (nt, 3, len(body.Pi))
        J, d, dd = (np.stack([np.broadcast_to(jet[k], shape) for jet in body.J], axis=1) for k in range(3))
        weighed = (J @ body.Pi).reshape(nt, len(body.J), -1)
        flat = [m.reshape(nt, len(body.J), -1).swapaxes(1, 2) for m in (J, d, dd)]
        at = np.ix_(range(nt), body.unknowns, body.unknowns)
        stiffness = weighed @ flat[2]
        felt = np.broadcast_to(body.V.dd, shape) @ body.Pi
        for (a, b), twice in body.second.items():
            value = np.einsum("tij,tij->t", np.broadcast_to(twice, shape), felt)
            stiffness[:, a, b] += value
            if a != b:
                stiffness[:, b, a] += value
        A[at] += weighed @ flat[0]
        B[at] += 2 * weighed @ flat[1]
        C[at] += stiffness
        Q[:, body.unknowns] -= np.einsum("taij,tij->ta", J, felt)
    return A, B, C, Q

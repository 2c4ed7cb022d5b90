"""The paper's perturbation model of a flexible spacecraft: [A] x'' + [B] x' + [C] x = Q about a nominal rigid motion.

The position field of a body is V z, z = (1, r, phi_1 .. phi_n), Pi = int z z^T dm once for each body, <U, W> = tr(U Pi W^T):

    A_ab = sum <J_a, J_b>      B_ab = 2 sum <J_a, J_b'> + dampers
    C_ab = sum <J_a, J_b''> + sum <d2V/dx_a dx_b, V''> + springs      Q_a = -sum <J_a, V''>

with J_a = dV/dx_a and ' the total time derivative along the nominal; products of truncated Taylor series in time give all of them.
The second derivatives of V are what the paper's linear W (Eqs 2-3) leaves out: without them C is wrong wherever the nominal accelerates.

Unknowns   x = [hinges and modes of each appendage, q (turn of the hub, hub axes), p (position, inertial axes)]
Source     "Equations of Motion of Flexible Spacecraft", Eqs (1)-(28); printed elements that differ: `printed.differences`
Loads      hinge springs and dampers and the strain are in; environment and inputs are not: they belong to the plant's own model
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .modal_data import ModalData
from .parameters import require_choice, require_finite
from .rotations import matrix_of, skew
from .signals import Signal, names, read_only, read_only_times

if TYPE_CHECKING:
    from .spacecraft import FlexibleSpacecraft

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

    def __matmul__(self, other: Jet) -> Jet:  # type: ignore[override]
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
    """What a rigid program supplies at times t (nt,): the hub's acceleration, attitude and rates, and the hinge angles of each
    appendage with two derivatives. Elastic coordinates are zero. Arrays are write-protected copies.
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
        moving = dx[:, at.velocity] if craft.translation else np.zeros((len(x), 3))
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


class _Body(NamedTuple):
    """A body's field and its derivatives with respect to its unknowns."""

    V: Jet  # (nt, 3, m)
    J: list[Jet]
    second: dict[tuple[int, int], Array]  # d2V/dx_a dx_b (nt, 3, m), a <= b
    data: ModalData | None
    Pi: Array
    unknowns: list[int]  # of the body among all


def _attitude(nominal: RigidNominal) -> Jet:
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


def _small(k: int, l: int | None = None) -> Array:
    """d/dq_k of exp(q~) at zero, or d2/dq_k dq_l: the symmetrised double cross product."""
    a = skew(E3[k])
    return a if l is None else (a @ skew(E3[l]) + skew(E3[l]) @ a) / 2


def _hub(craft: FlexibleSpacecraft, nominal: RigidNominal, R: Jet, q: list[int], p: list[int]) -> _Body:
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
    J = [_times(R, _small(k) @ wide) for k in range(3)]
    J += [Jet.constant(np.outer(E3[k], [1.0, 0, 0, 0])) for k in range(3)]
    second = {(k, l): R.value @ _small(k, l) @ wide for k in range(3) for l in range(k, 3)}
    return _Body(V, J, second, None, Pi, q + p)


def _appendage(craft: FlexibleSpacecraft, i: int, nominal: RigidNominal, R: Jet, own: list[int], qp: list[int]) -> _Body:
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
    small = [Jet.constant(_small(k)) for k in range(3)]
    J = [R @ d for d in by_hinge + by_mode] + [R @ small[k] @ inner for k in range(3)]
    J += [Jet.constant(np.outer(E3[k], np.eye(m)[0])) for k in range(3)]
    second, Rv, first = {}, R.value, nh + n
    for j in range(nh):
        for l in range(j, nh):
            second[j, l] = Rv @ _times(C(j, l), wide).value
        for k in range(n):
            second[j, nh + k] = Rv @ _times(C(j), phi[k]).value
    for a, d in enumerate(by_hinge + by_mode):
        for k in range(3):
            second[a, first + k] = Rv @ _small(k) @ d.value
    for k in range(3):
        for l in range(k, 3):
            second[first + k, first + l] = Rv @ _small(k, l) @ inner.value
    return _Body(V, J, second, data, data.pi, own + qp)


@dataclass(frozen=True, eq=False)
class SecondOrderModel:
    """[A] x'' + [B] x' + [C] x = Q at the times t; arrays (nt, n, n) and (nt, n). Q_u (nt, n, nu) multiplies input deviations."""

    t: Array = field(repr=False)
    A: Array = field(repr=False)
    B: Array = field(repr=False)
    C: Array = field(repr=False)
    Q: Array = field(repr=False)
    coordinates: tuple[Signal, ...]
    parts: tuple[tuple[str, tuple[int, ...]], ...] = ()  # ("1", indices) .. ("m", indices): appendages and main body
    Q_u: Array | None = field(default=None, repr=False)

    def block(self, name: str) -> Array:
        """A block under the paper's name: "A_11", "A_1m", "A_m1", "B_mm", "C_2m" .. , "Q_1", "Q_m" (nt, ..); the rows of m are q, then p."""
        kind, _, place = name.partition("_")
        known = dict(self.parts)
        rows = known.get(place[:-1]) if kind != "Q" else known.get(place)
        columns = known.get(place[-1:])
        if kind in ("A", "B", "C") and rows is None:  # two appendage numbers of several digits
            split = [k for k in range(1, len(place)) if place[:k] in known and place[k:] in known]
            rows, columns = (known[place[: split[0]]], known[place[split[0] :]]) if split else (None, None)
        if kind not in ("A", "B", "C", "Q") or rows is None or columns is None:
            raise ValueError(f"block {name!r} must be A_, B_, C_ with two of, or Q_ with one of {', '.join(known)}")
        if kind == "Q":
            return self.Q[:, list(rows)]
        return getattr(self, kind)[:, list(rows)][:, :, list(columns)]

    def eigenvalues(self, k: int) -> Array:
        """Roots frozen at node k (2 n,), in these coordinates: position in inertial axes, turn in hub axes."""
        n = self.A.shape[1]
        M = np.zeros((2 * n, 2 * n))
        M[:n, n:] = np.eye(n)
        M[n:] = -np.linalg.solve(self.A[k], np.hstack([self.C[k], self.B[k]]))
        return np.linalg.eigvals(M)

    def first_order(self) -> tuple[Array, Array]:
        """(A (nt, 2 n, 2 n), c (nt, 2 n)) of z = [x; x']: z' = A z + c."""
        n, nt = self.A.shape[1], len(self.t)
        M, c = np.zeros((nt, 2 * n, 2 * n)), np.zeros((nt, 2 * n))
        M[:, :n, n:] = np.eye(n)
        M[:, n:] = -np.linalg.solve(self.A, np.concatenate([self.C, self.B], axis=2))
        c[:, n:] = np.linalg.solve(self.A, self.Q[..., None])[..., 0]
        return M, c


def perturbation(craft: FlexibleSpacecraft, nominal: RigidNominal | Any) -> SecondOrderModel:
    """The paper's model of `craft` about a rigid nominal (a RigidNominal, or a trajectory of the plant's states).

    The shortening of stiffened kinematics enters C_ii as geometric stiffness -<g_kl, V''>. ValueError for varied parameters, wheels or
    an orbit, which the paper's model does not have.
    """
    if craft.varied or craft.hub.wheels or craft.environment.orbit is not None:
        raise ValueError("perturbation: the paper's model has no varied parameters, wheels or orbit axes")
    if not isinstance(nominal, RigidNominal):
        nominal = RigidNominal.of(craft, nominal)
    _check(craft, nominal)
    own, signals, parts = [], [], []
    for i, body in enumerate(craft.appendages):
        count = body.hinge.n + craft.mode_counts[i]
        own.append(list(range(len(signals), len(signals) + count)))
        at = craft.layout
        first = at.quaternion.stop
        places = [k - first for s in (at.hinges[i], at.modes[i]) for k in range(s.start, s.stop)]
        signals += [craft.coordinates[k] for k in places]
        parts.append((str(i + 1), tuple(own[-1])))
    n = len(signals) + 6
    q, p = [n - 6, n - 5, n - 4], [n - 3, n - 2, n - 1]
    signals += [Signal(f"q_{c}", "rad") for c in "xyz"] + [Signal(f"p_{c}", "m") for c in "xyz"]
    parts.append(("m", tuple(q + p)))
    R = _attitude(nominal)
    bodies = [_hub(craft, nominal, R, q, p)]
    bodies += [_appendage(craft, i, nominal, R, own[i], q + p) for i in range(len(own))]
    A, B, C, Q = assemble(bodies, len(nominal.t), n)
    for i, body in enumerate(bodies[1:]):
        _strain(craft, i, body, nominal, own[i], B, C, Q)
    return SecondOrderModel(nominal.t, A, B, C, Q, tuple(signals), tuple(parts))


def _check(craft: FlexibleSpacecraft, nominal: RigidNominal) -> None:
    for name in ("angles", "angle_rates", "angle_accelerations"):
        widths = tuple(a.shape[1] for a in getattr(nominal, name))
        want = tuple(a.hinge.n for a in craft.appendages)
        if widths != want and (widths or any(want)):
            raise ValueError(f"RigidNominal.{name} has columns {widths}, must have {want} (the hinges' freedoms)")


def assemble(bodies: list[_Body], nt: int, n: int) -> tuple[Array, Array, Array, Array]:
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


def _strain(
    craft: FlexibleSpacecraft, i: int, body: _Body, nominal: RigidNominal, own: list[int], B: Array, C: Array, Q: Array
) -> None:
    """Springs, dampers, modal stiffness and, stiffened, the work of the inertia forces on the shortening."""
    appendage, n, data = craft.appendages[i], craft.mode_counts[i], body.data
    assert data is not None
    nh = appendage.hinge.n
    turns, bent = own[:nh], own[nh:]
    K, D = np.array(appendage.hinge.stiffness, dtype=float), np.array(appendage.hinge.damping, dtype=float)
    C[:, turns, turns] += K
    B[:, turns, turns] += D
    if nh:
        Q[:, turns] -= nominal.angles[i] * K + nominal.angle_rates[i] * D
    if not n:
        return
    ratio = 2 * appendage.damping * np.sqrt(np.diag(data.stiffness) * np.diag(data.modal_mass))
    pair = np.ix_(range(len(nominal.t)), bent, bent)
    C[pair] += appendage.stiffness_factor * data.stiffness
    B[pair] += data.damping + np.diag(ratio)
    if craft.kinematics == "stiffened":
        felt = _axes(body, nh) @ body.V.dd  # in appendage axes: acceleration of the field (1, r, ..)
        C[pair] -= np.einsum("ti,kli->tkl", felt[:, :, 0], data.shortening)
        moments = (data.shortening_moments + data.shortening_moments.swapaxes(0, 1)) / 2
        C[pair] -= np.einsum("tij,klji->tkl", felt[:, :, 1:4], moments)


def _axes(body: _Body, nh: int) -> Array:
    """Inertial axes to appendage axes (nt, 3, 3), from the field of the first mode."""
    J = body.J[nh].value
    return np.swapaxes(J[:, :, 4:7], 1, 2)


def residual(model: SecondOrderModel, x: Any, v: Any, a: Any) -> Array:
    """[A] a + [B] v + [C] x - Q (nt, n) at deviations x, their rates v and accelerations a, each (n,) or (nt, n)."""
    require_choice("residual", "number of unknowns", np.shape(x)[-1], (model.A.shape[1],))
    parts = [np.einsum("tij,tj->ti", m, np.broadcast_to(z, model.Q.shape)) for m, z in zip((model.A, model.B, model.C), (a, v, x))]
    return require_finite("residual", parts[0] + parts[1] + parts[2] - model.Q, model.Q.shape)

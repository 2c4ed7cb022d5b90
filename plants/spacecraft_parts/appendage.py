"""A flexible body on a hinge: its kinematics, its inertia and its share of the spacecraft's equations.

Axes     C takes appendage axes to hub axes: the mounting times one turn about each hinge axis in order
Motion   of the origin (acceleration a0), of the axes (omega, alpha) and of the modes; all in appendage axes
Source   "Equations of Motion of Flexible Spacecraft", Eqs (2)-(13): the energy of (8) gives M_A(eta) below, and
         Lagrange's equations in quasi-coordinates (Hamel) the rest, so that momentum and energy hold for every
         truncation.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import as_tuple, nested, real_array, require_instance, shown, unit_vector
from pliant.plants.core.parameters import part, quantity, require_choice, require_count, validate
from pliant.plants.core.quaternions import about, cross, matrix_of
from pliant.plants.modal_data.integrals import axial
from pliant.plants.modal_data.modal_data import ModalData

from .environment import Surface

DRIVES = ("free", "torque", "angle", "motion")
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def constant(value: Any) -> ca.SX:
    """A numeric array as an expression without its zeros."""
    return ca.SX(ca.sparsify(ca.DM(np.asarray(value, dtype=float))))


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """Up to three turns in sequence about `axes`, unit vectors in mounting axes (the first is fixed to the hub).

    drive   "free": spring and damper only; "torque": a motor torque is an input [N m]; "angle": the spring's rest
            angle is an input (a commanded angle history) [rad]; "motion": the angular acceleration is an input
            [rad/s^2]
    """

    axes: tuple[tuple[float, float, float], ...] = ()
    stiffness: Any = quantity("N m/rad", "nonnegative", (), shape=(-1,))  # one for each axis, or one number for all
    damping: Any = quantity("N m s/rad", "nonnegative", (), shape=(-1,))
    drive: str = "free"

    def __post_init__(self) -> None:
        axes = as_tuple("Hinge.axes", nested(self.axes))
        require_count("Hinge", "number of axes", len(axes), 0, 3)
        axes = tuple(unit_vector(f"Hinge.axes[{j}]", axis) for j, axis in enumerate(axes))
        object.__setattr__(self, "axes", axes)
        for name in ("stiffness", "damping"):
            value = nested(getattr(self, name))
            if not isinstance(value, tuple):
                value = (value,) * len(self.axes)
            value = value or (0.0,) * len(self.axes)
            if len(value) != len(self.axes):
                raise ValueError(f"Hinge.{name} = {value!r} must have one value for each of {len(self.axes)} axes")
            object.__setattr__(self, name, value)
        validate(self)
        require_choice("Hinge", "drive", self.drive, DRIVES)

    @property
    def n(self) -> int:
        """Freedoms."""
        return len(self.axes)


@dataclass(frozen=True, kw_only=True)
class Appendage:
    """A body hinged to the hub at `position`. `modes`: how many (the slowest), for a beam also (in x-y, in x-z);
    None: all given.

    A beam lies along x of its axes. `orientation`: a rotation matrix, or a quaternion (scalar first), from
    appendage axes to hub axes with the hinge at zero. `damping` is a ratio added to every mode's own damping;
    `stiffness_factor` multiplies the modal stiffness, and can be varied where the modal data cannot.
    """

    position: Any = quantity("m", "finite", shape=(3,))
    body: Beam | ModalData = field(metadata={"fixed": "becomes modal data; vary its stiffness_factor instead"})
    orientation: Any = IDENTITY
    modes: int | tuple[int, int] | None = None
    hinge: Hinge = part(Hinge, default_factory=Hinge)
    damping: Any = quantity("1", "nonnegative", 0.0, uncertain=True)
    stiffness_factor: Any = quantity("1", "positive", 1.0, uncertain=True)
    surface: Surface | None = None  # what the sun shines on, spread over the body as its mass is

    def __post_init__(self) -> None:
        validate(self)
        if not isinstance(self.body, (Beam, ModalData)):
            raise ValueError(f"Appendage.body = {shown(self.body)} must be a Beam or ModalData")
        if self.surface is not None:
            require_instance("Appendage.surface", self.surface, Surface)
        object.__setattr__(self, "modes", nested(self.modes))
        turn = real_array("Appendage.orientation", self.orientation)
        if turn.shape == (4,) and np.linalg.norm(turn) > 0:
            turn = matrix_of(turn)
        if turn.shape != (3, 3) or not np.abs(turn @ turn.T - np.eye(3)).max() < 1e-9 or np.linalg.det(turn) < 0:
            raise ValueError(f"Appendage.orientation = {self.orientation!r} must be a rotation matrix or a quaternion")
        object.__setattr__(self, "orientation", tuple(tuple(float(v) for v in row) for row in turn))
        if isinstance(self.modes, tuple) and not isinstance(self.body, Beam):
            raise ValueError(f"Appendage.modes = {self.modes!r} must be a count: the body is ModalData")
        if isinstance(self.modes, tuple) and len(self.modes) != 2:
            raise ValueError(f"Appendage.modes = {self.modes!r} must be a count or two, in x-y and in x-z")
        most = self.body.n if isinstance(self.body, ModalData) else 100
        for count in self.modes if isinstance(self.modes, tuple) else () if self.modes is None else (self.modes,):
            require_count("Appendage", "modes", count, 0, most)

    @cached_property
    def data(self) -> ModalData:
        """The modal data of all its modes."""
        if isinstance(self.body, ModalData):
            return self.body if not isinstance(self.modes, int) else self.body.slowest(self.modes)
        if isinstance(self.modes, tuple):
            return ModalData.boom(self.body, self.modes)
        count = 1 if self.modes is None else self.modes
        return ModalData.boom(self.body, (count, count)).slowest(count)

    def turn(self, theta: ca.SX) -> ca.SX:
        """C (3, 3), appendage axes to hub axes, at hinge angles (nh,)."""
        C = constant(self.orientation)
        for j, axis in enumerate(self.hinge.axes):
            C = C @ about(axis, theta[j])
        return C

    def hinge_rates(self, theta: ca.SX) -> ca.SX:
        """G (3, nh): the appendage turns relative to the hub at G dtheta/dt, in its own axes."""
        columns, after = [], ca.SX.eye(3)
        for j in reversed(range(self.hinge.n)):
            columns.append(after.T @ constant(self.hinge.axes[j]))
            after = about(self.hinge.axes[j], theta[j]) @ after
        return ca.horzcat(*reversed(columns)) if columns else ca.SX(3, 0)

    def strain_force(self, eta: ca.SX, rate: ca.SX) -> ca.SX:
        """Stiffness and damping forces of the modes (n,), as they enter the left-hand side."""
        n, data = eta.shape[0], self.data
        if not n:
            return ca.SX(0, 1)
        K, ratio = data.stiffness[:n, :n], np.sqrt(np.diag(data.stiffness) * np.diag(data.modal_mass))[:n]
        return self.stiffness_factor * (constant(K) @ eta) + self.dissipation(n, ratio) @ rate

    def dissipation(self, n: int, ratio: np.ndarray | None = None) -> ca.SX:
        """Modal damping (n, n) with the added ratio."""
        data = self.data
        if ratio is None:
            ratio = np.sqrt(np.diag(data.stiffness) * np.diag(data.modal_mass))[:n]
        return constant(data.damping[:n, :n]) + self.damping * constant(np.diag(2 * ratio))

    def strain_energy(self, eta: ca.SX) -> ca.SX:
        """(1/2) eta K eta [J]."""
        n = eta.shape[0]
        return self.stiffness_factor * ca.dot(eta, constant(self.data.stiffness[:n, :n]) @ eta) / 2 if n else ca.SX(0)


class _Fields(NamedTuple):
    """The modes and, behind them, the shortening fields g_kl of the pairs k <= l that are not zero."""

    R: np.ndarray
    moments: np.ndarray
    overlaps: np.ndarray
    pairs: list[tuple[int, int]]

    @classmethod
    def of(cls, data: ModalData, n: int, stiffened: bool) -> _Fields:
        found = [
            (k, l) for k in range(n) for l in range(k, n) if stiffened and data.shortening_squares[k, l, k, l].any()
        ]
        k, l = [p[0] for p in found], [p[1] for p in found]
        mixed = data.shortening_overlaps[:n, k, l]
        squares = data.shortening_squares[k, l][:, k, l]
        overlaps = np.block(
            [[_flat(data.overlaps[:n, :n]), _flat(mixed)], [_flat(mixed.transpose(1, 0, 3, 2)), _flat(squares)]]
        )
        count = n + len(found)
        return cls(
            np.concatenate([data.R[:n], data.shortening[k, l]]),
            np.concatenate([data.moments[:n], data.shortening_moments[k, l]]),
            overlaps.reshape(count, 3, count, 3).transpose(0, 2, 1, 3),
            found,
        )


def _columns(blocks: np.ndarray) -> np.ndarray:
    """(k, ..) as columns (size of one, k)."""
    return blocks.reshape(len(blocks), -1).T


def _flat(blocks: np.ndarray) -> np.ndarray:
    """(a, b, 3, 3) as a matrix (3 a, 3 b)."""
    a, b = blocks.shape[:2]
    return blocks.transpose(0, 2, 1, 3).reshape(3 * a, 3 * b)


@dataclass(frozen=True)
class Inertia:
    """The moments of a deformed body in its own axes."""

    mass: float
    S: ca.SX  # int s dm (3,)
    P: ca.SX  # int s s^T dm (3, 3)
    R: ca.SX  # int ds/deta dm (3, n)
    Y: ca.SX  # int s x ds/deta dm (3, n)
    m: ca.SX  # (n, n)

    @classmethod
    def of(cls, data: ModalData, eta: ca.SX, stiffened: bool) -> Inertia:
        """At eta (n,). Shortening -(1/2) g_kl eta_k eta_l is a field like a mode's, its amplitude a function of eta,
        so that the energy is that of a motion of the points and M_A stays positive definite.
        """
        n = eta.shape[0]
        fields, amplitudes = _Fields.of(data, n, stiffened), [eta[k] for k in range(n)]
        amplitudes += [-eta[k] * eta[l] / (2 if k == l else 1) for k, l in fields.pairs]
        S, P, Y = constant(data.first), constant(data.second), ca.SX(3, 0)
        if amplitudes:
            c, count = ca.vertcat(*amplitudes), len(amplitudes)
            a, b = np.triu_indices(count)
            squares = fields.overlaps[a, b] + np.where(a == b, 0.0, 1.0)[:, None, None] * fields.overlaps[b, a]
            linear = fields.moments + fields.moments.transpose(0, 2, 1)
            S = S + constant(fields.R.T) @ c
            P = P + ca.reshape(constant(_columns(linear)) @ c, 3, 3)
            P = P + ca.reshape(constant(_columns(squares)) @ (c[a.tolist()] * c[b.tolist()]), 3, 3)
            Y = constant(axial(fields.moments).T)
            Y = Y + ca.reshape(constant(_columns(axial(fields.overlaps))) @ c, 3, count)
        R = constant(fields.R.T) if amplitudes else ca.SX(3, 0)
        m = constant(np.einsum("abii->ab", fields.overlaps)) if amplitudes else ca.SX(0, 0)
        if fields.pairs:
            slopes = ca.vertcat(ca.SX.eye(n), ca.jacobian(ca.vertcat(*amplitudes[n:]), eta))
            R, Y, m = R @ slopes, Y @ slopes, slopes.T @ m @ slopes
        return cls(float(data.mass), S, P, R, Y, m)

    @property
    def tensor(self) -> ca.SX:
        """Inertia about the origin (3, 3)."""
        return ca.trace(self.P) * ca.SX.eye(3) - self.P

    @property
    def matrix(self) -> ca.SX:
        """M_A (6 + n, 6 + n) for (velocity of the origin, omega, deta/dt)."""
        S = cross(self.S)
        return ca.vertcat(
            ca.horzcat(self.mass * ca.SX.eye(3), -S, self.R),
            ca.horzcat(S, self.tensor, self.Y),
            ca.horzcat(self.R.T, self.Y.T, self.m),
        )

    def momenta(self, omega: ca.SX, rate: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Linear, angular and modal momentum of the motion relative to the origin's."""
        p = cross(omega) @ self.S + self.R @ rate
        h = self.tensor @ omega + self.Y @ rate
        return p, h, self.Y.T @ omega + self.m @ rate

    def bias(self, omega: ca.SX, eta: ca.SX, rate: ca.SX) -> ca.SX:
        """(6 + n,): what M_A (a0, alpha, d2eta/dt2) lacks of the rates of the momenta; without strain forces."""
        p, h, modal = self.momenta(omega, rate)
        if not eta.shape[0]:
            return ca.vertcat(cross(omega) @ p, cross(omega) @ h)
        T = ca.dot(omega, self.tensor @ omega) / 2 + ca.dot(rate, self.Y.T @ omega) + ca.dot(rate, self.m @ rate) / 2
        along = ca.jtimes(ca.vertcat(p, h, modal), eta, rate)
        return along + ca.vertcat(cross(omega) @ p, cross(omega) @ h, -ca.gradient(T, eta))

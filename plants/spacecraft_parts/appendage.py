"""A flexible body on a hinge: its kinematics and its strain.

Axes     C takes appendage axes to hub axes: the mounting times one turn about each hinge axis in order
Motion   of the origin (acceleration a0), of the axes (omega, alpha) and of the modes; all in appendage axes
Source   "Equations of Motion of Flexible Spacecraft", Eqs (2)-(13): the energy of (8) gives M_A(eta) below, and
         Lagrange's equations in quasi-coordinates (Hamel) the rest, so that momentum and energy hold for every
         truncation.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import as_tuple, nested, real_array, require_instance, shown, unit_vector
from pliant.plants.core.parameters import part, quantity, require_choice, require_count, validate
from pliant.plants.core.quaternions import about, matrix_of
from pliant.plants.modal_data.deformed_body import constant
from pliant.plants.modal_data.modal_data import ModalData

from .environment import Surface

DRIVES = ("free", "torque", "angle", "motion")
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


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

"""The rigid hub of a spacecraft with what acts on it: reaction wheels and thrusters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import nested, require_all, unit_vector
from pliant.plants.core.parameters import is_symbolic, quantity, validate
from pliant.plants.core.quaternions import cross

from .environment import Surface


def _mirrored(inertia: tuple[tuple[Any, ...], ...]) -> tuple[tuple[Any, ...], ...]:
    """The tensor whose symbols stand in both of their places: one name varies a product of inertia."""

    def at(i: int, j: int) -> Any:
        return inertia[i][j] if is_symbolic(inertia[i][j]) or not is_symbolic(inertia[j][i]) else inertia[j][i]

    return tuple(tuple(at(i, j) for j in range(3)) for i in range(3))


@dataclass(frozen=True, kw_only=True)
class Wheel:
    """A reaction wheel about `axis` (hub axes). Its input is the motor's torque on the hub; its state the axial
    momentum.

    The hub's mass and inertia include the wheel, less `inertia` about its axis.
    """

    axis: tuple[float, float, float]
    inertia: Any = quantity("kg m^2", "positive")
    friction: Any = quantity("N m s/rad", "nonnegative", 0.0)

    def __post_init__(self) -> None:
        validate(self)
        object.__setattr__(self, "axis", unit_vector("Wheel.axis", self.axis))

    def speed(self, momentum: ca.SX, omega: ca.SX) -> ca.SX:
        """Speed relative to the hub [rad/s] from the axial momentum [N m s] and the hub's rate."""
        return momentum / self.inertia - ca.dot(ca.DM(self.axis), omega)


@dataclass(frozen=True, kw_only=True)
class Thruster:
    """A thruster at `position` that pushes the hub along `direction` (hub axes); its input is the force [N]."""

    position: Any = quantity("m", "finite", shape=(3,))
    direction: tuple[float, float, float]

    def __post_init__(self) -> None:
        validate(self)
        object.__setattr__(self, "direction", unit_vector("Thruster.direction", self.direction))


@dataclass(frozen=True, kw_only=True)
class Hub:
    """A rigid body; origin at its mass centre. Without wheels and thrusters its inputs are three torques in its axes.

    `inertia`: three principal moments or a full 3 x 3 tensor. To `vary` a product of inertia, one of its two places is
    named.
    """

    mass: Any = quantity("kg", "positive")
    inertia: Any = quantity("kg m^2", "finite", shape=(3, 3))
    wheels: tuple[Wheel, ...] = ()
    thrusters: tuple[Thruster, ...] = ()
    surfaces: tuple[Surface, ...] = ()

    def __post_init__(self) -> None:
        for name, kind in (("wheels", Wheel), ("thrusters", Thruster), ("surfaces", Surface)):
            object.__setattr__(self, name, require_all(f"Hub.{name}", getattr(self, name), kind))
        I = nested(self.inertia)
        if isinstance(I, tuple) and len(I) == 3 and not any(isinstance(row, tuple) for row in I):
            I = ((I[0], 0.0, 0.0), (0.0, I[1], 0.0), (0.0, 0.0, I[2]))
        object.__setattr__(self, "inertia", I)
        validate(self)
        if any(is_symbolic(v) for row in self.inertia for v in row):
            object.__setattr__(self, "inertia", _mirrored(self.inertia))
            return
        tensor = np.array(self.inertia, dtype=float)
        if np.abs(tensor - tensor.T).max() > 1e-9 * np.abs(tensor).max() or np.linalg.eigvalsh(tensor)[0] <= 0:
            raise ValueError(f"Hub.inertia = {self.inertia!r} must be symmetric and positive definite [kg m^2]")
        if any(is_symbolic(w.inertia) for w in self.wheels):
            return
        moments = np.linalg.eigvalsh(sum((w.inertia * np.outer(w.axis, w.axis) for w in self.wheels), tensor))
        if moments[2] > (1 + 1e-6) * (moments[0] + moments[1]):
            raise ValueError(
                f"Hub.inertia = {self.inertia!r}: the largest principal moment {moments[2]:.6g} kg m^2 must be <= "
                f"{moments[0] + moments[1]:.6g}, the sum of the others, as of any body"
            )

    @property
    def tensor(self) -> ca.SX:
        """Inertia (3, 3) [kg m^2]."""
        return ca.sparsify(ca.vertcat(*[ca.horzcat(*[ca.SX(v) for v in row]) for row in self.inertia]))

    def momentum(self, omega: ca.SX, wheels: ca.SX) -> ca.SX:
        """Angular momentum (3,) about the hub's mass centre [N m s], wheels' axial momenta (nw,) included."""
        return self.tensor @ omega + sum((ca.DM(w.axis) * wheels[k] for k, w in enumerate(self.wheels)), ca.SX.zeros(3))

    def bias(self, omega: ca.SX, wheels: ca.SX) -> ca.SX:
        """(6,): what (m a, I alpha) lacks of the rates of the momenta."""
        return ca.vertcat(ca.SX.zeros(3), cross(omega) @ self.momentum(omega, wheels))

    def wheel_torques(self, omega: ca.SX, wheels: ca.SX, u: ca.SX) -> ca.SX:
        """Torque of each wheel on the hub (nw,) [N m]: motor and bearing friction."""
        return ca.vertcat(*[u[k] + w.friction * w.speed(wheels[k], omega) for k, w in enumerate(self.wheels)])

    def actuation(self, omega: ca.SX, wheels: ca.SX, u: ca.SX) -> ca.SX:
        """Force and torque (6,) of wheels and thrusters, or of three torques where there are none."""
        if not self.wheels and not self.thrusters:
            return ca.vertcat(ca.SX.zeros(3), u)
        load, n = ca.SX.zeros(6), len(self.wheels)
        if n:
            torques = self.wheel_torques(omega, wheels, u)
            for k, wheel in enumerate(self.wheels):
                load[3:] += ca.DM(wheel.axis) * torques[k]
        for k, thruster in enumerate(self.thrusters):
            force = ca.DM(thruster.direction) * u[n + k]
            load += ca.vertcat(force, ca.cross(ca.vertcat(*thruster.position), force))
        return load

    @property
    def axes(self) -> tuple[str | None, ...]:
        """For each input the hub axis that it turns about, None for a thrust and a wheel about another direction."""
        if not self.wheels and not self.thrusters:
            return ("x", "y", "z")
        turned = (np.asarray(w.axis) for w in self.wheels)
        about = ("xyz"[int(np.argmax(axis))] if axis.max() == 1.0 else None for axis in turned)
        return (*about, *(None for _ in self.thrusters))

    @property
    def inputs(self) -> int:
        """How many inputs."""
        return len(self.wheels) + len(self.thrusters) or 3

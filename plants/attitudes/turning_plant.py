"""Plants M dv/dt = r whose coordinates q may hold unit quaternions: dq/dt is v but there, where it is Xi omega / 2.

States   x = [q; v]; one coordinate more than speeds for each quaternion
Source   the deviations are those of the spacecraft's paper, "Equations of Motion of Flexible Spacecraft"
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import real_array, require_by_name, require_choice
from pliant.plants.core.casadi_functions import NumericFunction, built_once
from pliant.plants.core.quaternions import rates
from pliant.plants.core.signals import Signal, Unfelt, index, names
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.equilibrium import RestConditions
from pliant.plants.dynamics.lagrangian import LagrangianPlant
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from . import linear
from .deviations import Attitude, Deviations
from .feedback import feedback_model
from .rests import TurnedForces, stiffness

Array = np.ndarray
UNIT = 1e-3  # how far from 1 the norm of a quaternion that is given may be
KINDS = ("rotation", "quaternion")


@dataclass(frozen=True, kw_only=True)
class TurningPlant(LagrangianPlant):
    """M(q) dv/dt = r(t, q, v, u, w). Without quaternions it is a LagrangianPlant like others."""

    @property
    @abstractmethod
    def speeds(self) -> tuple[Signal, ...]:
        """v, in order."""

    @property
    @abstractmethod
    def turns(self) -> tuple[tuple[str, int, int], ...]:
        """(name, first of its coordinates, first of its speeds) of each quaternion."""

    @property
    def held(self) -> Mapping[str, float]:
        """Coordinates of which no force knows, as a free machine's place: held by `equilibrium` unless named."""
        return {}

    @cached_property
    def attitudes(self) -> tuple[Attitude, ...]:
        """The quaternions."""
        n = len(self.coordinates)
        return tuple(Attitude(name, q, n + v) for name, q, v in self.turns)

    @cached_property
    def small(self) -> Deviations:
        """How deviations follow from states."""
        return Deviations(self.attitudes, self.nx)

    @property
    def states(self) -> tuple[Signal, ...]:
        return (*self.coordinates, *self.speeds)

    @cached_property
    def deviations(self) -> tuple[Signal, ...]:
        """The states of its linear models."""
        found = [Signal("", "")] * self.small.n
        for k in self.small.kept:
            found[self.small.at(k)] = self.states[k]
        for a in self.attitudes:
            found[self.small.turn(a)] = [Signal(f"{a.name}_turn_{c}", "rad") for c in "xyz"]
            found[self.small.spin(a)] = [Signal(f"{a.name}_turn_{c}_rate", "rad/s") for c in "xyz"]
        return tuple(found)

    @cached_property
    def rates(self) -> dict[str, str]:
        """Of coordinates that are no parts of quaternions."""
        n, spins = len(self.coordinates), [k for a in self.attitudes for k in range(a.omega, a.omega + 3)]
        own = [k for k in self.small.kept if k < n]
        after = [k for k in range(n, self.nx) if k not in spins]
        return {self.states[i].name: self.states[j].name for i, j in zip(own, after, strict=True)}

    @property
    def velocities(self) -> tuple[str, ...]:
        """Of its linear models too."""
        return tuple(dict.fromkeys((*names(self.speeds), *names(self.deviations[-len(self.speeds) :]))))

    @property
    def prescribed(self) -> tuple[str, ...]:
        known, given = {s.name: i for i, s in enumerate(self.speeds)}, self.driven
        own = tuple(name for name, rate in self.rates.items() if known[rate] in given)
        turned = (a for a, (_, _, v) in zip(self.attitudes, self.turns, strict=True) if v in given)
        return (*own, *(s.name for a in turned for s in self.states[a.quaternion]))

    @property
    def lockable(self) -> tuple[str, ...]:
        return tuple(name for name in self.rates if name not in {*self.prescribed, *self.held})

    @property
    def attitude_states(self) -> tuple[str, ...]:
        return tuple(s.name for a in self.attitudes for s in self.states[a.quaternion])

    @property
    def attitude_outputs(self) -> tuple[str, ...]:
        return tuple(f"{a.name}_attitude_{c}" for a in self.attitudes for c in "xyz")

    def coordinate_rates(self, x: ca.SX) -> ca.SX:
        n = len(self.coordinates)
        v, parts, q, at = x[n:], [], 0, 0
        for _, first, spin in self.turns:
            parts += [v[at : at + first - q], rates(x[first : first + 4]) @ v[spin : spin + 3] / 2]
            q, at = first + 4, spin + 3
        return ca.vertcat(*parts, v[at:])

    def check_state(self, x: Array) -> None:
        """Raise ValueError where a quaternion of x (..., nx) is not of unit length."""
        for a in self.attitudes:
            norm = np.atleast_1d(np.linalg.norm(x[..., a.quaternion], axis=-1))
            worst = float(norm[np.argmax(np.abs(norm - 1))])
            if not abs(worst - 1) <= UNIT:
                raise ValueError(
                    f"{type(self).__name__}.x: the quaternion of {a.name!r} has norm {worst:.6g}, must be 1; see "
                    "`state`"
                )

    def consistent(self, x: Array) -> Array:
        """x (..., nx) with unit quaternions: no turn where one is zero."""
        if not self.attitudes:
            return x
        x = np.array(real_array(f"{type(self).__name__}.x", x))
        if x.shape[-1:] != (self.nx,):
            raise ValueError(f"{type(self).__name__}.x has shape {x.shape}, must be (..., {self.nx})")
        for a in self.attitudes:
            x[..., a.q] += (x[..., a.quaternion] == 0).all(axis=-1)
            x[..., a.quaternion] /= np.linalg.norm(x[..., a.quaternion], axis=-1, keepdims=True)
        return x

    def state(self, values: Mapping[str, float] | None = None, **named: float) -> Array:
        """x (nx,) with these states by name; the others zero, nothing turned where no quaternion is named."""
        owner = f"{type(self).__name__}.state"
        x = np.array(self.rest_state)
        given = {} if values is None else require_by_name(f"{owner}.values", values)
        for name, value in (given | require_by_name(owner, named)).items():
            x[index(self.states, name, "state")] = value
        return x

    def rest_conditions(self, p: Any = None) -> RestConditions:
        return TurnedForces(self, p) if self.attitudes else super().rest_conditions(p)

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[Array, Array]:
        """A rest point as in Plant.equilibrium. The search begins with nothing turned; place and attitude of a free
        base are held, at zero where they are not named.
        """
        first = {self.states[a.q].name: 1.0 for a in self.attitudes}
        given = first | ({} if guess is None else dict(require_by_name("equilibrium.guess", guess)))
        fixed = {} if fixed is None else require_by_name("equilibrium.fixed", fixed)
        return super().equilibrium({**self.held, **fixed, **named}, guess=given, p=p)

    @built_once
    def _stiffness(self) -> NumericFunction:
        return stiffness(self)

    @property
    def unfelt(self) -> Unfelt:
        """Place and attitude of a free base, in states or deviations; coordinates in given motion."""
        given = (*self.prescribed, *(self.rates[name] for name in self.prescribed if name in self.rates))
        if not self.held:
            return Unfelt((), given if self.attitudes else ())
        places = tuple(name for name in self.rates if name in self.held)
        turned = [a for a in self.attitudes if self.states[a.q].name in self.held]
        quaternions = tuple(s.name for a in turned for s in self.states[a.quaternion])
        return Unfelt((places, quaternions, tuple(f"{a.name}_turn_{c}" for a in turned for c in "xyz")), given)

    def linearize(
        self,
        x0: Any,
        u0: Any = None,
        *,
        w: Any = None,
        p: Any = None,
        t: float = 0.0,
        attitude: Literal["rotation", "quaternion"] = "rotation",
    ) -> LinearModel:
        """The linear model at (x0, u0). attitude "rotation": of each quaternion the deviations are three small turns
        and their rates, see `deviations`; "quaternion": the plant's own states, as for any plant.
        """
        require_choice("linearize", "attitude", attitude, KINDS)
        if not self.attitudes:
            return super().linearize(x0, u0, w=w, p=p, t=t)
        if attitude == "quaternion":
            own = super().linearize(x0, u0, w=w, p=p, t=t)
            self.check_state(own.x0)
            return own
        return linear.linearize(self, x0, u0, w, p, t)

    def linearize_along(
        self, nominal: Trajectory, *, p: Any = None, attitude: Literal["rotation", "quaternion"] = "rotation"
    ) -> LTVModel:
        """The time-varying model about any nominal motion of this plant's states, as `linearize`."""
        require_choice("linearize_along", "attitude", attitude, KINDS)
        if attitude == "quaternion" or not self.attitudes:
            return super().linearize_along(nominal, p=p)
        return linear.along(self, nominal, p)

    def jump_map(self, x: Array, P: Array, *, after: Array, p: Any = None, t: float = 0.0) -> tuple[Array, Array]:
        """As of any plant, in this one's deviations."""
        own = super().jump_map(x, P, after=after, p=p, t=t)
        return linear.jump(self, x, after, own, t) if self.attitudes else own

    def feedback_model(self, x0: Any, u0: Any = None, *, p: Any = None) -> LinearModel:
        """The linear model in signals: attitude outputs for quaternions, angular velocities for the rates of turns.

        Where an attitude turns at (x0, u0) it is left out; ValueError where the rest feels it.
        """
        return feedback_model(self, x0, u0, p) if self.attitudes else super().feedback_model(x0, u0, p=p)

"""What plants with unit quaternions among their states have alike: states that are some, linear models in small turns.

Source   the deviations are those of the spacecraft's paper, "Equations of Motion of Flexible Spacecraft"
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_by_name, require_choice
from pliant.plants.core.signals import Signal, index
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.arguments import one_state
from pliant.plants.dynamics.mechanical import MechanicalPlant
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from . import linear
from .deviations import Attitude, Deviations
from .feedback import feedback_model

Array = np.ndarray
UNIT = 1e-3  # how far from 1 the norm of a quaternion that is given may be
KINDS = ("rotation", "quaternion")


@dataclass(frozen=True, kw_only=True)
class AttitudePlant(MechanicalPlant):
    """Its linear models are in small turns of its attitudes; `attitude_outputs` are three of each. Without any it is a
    plant like others.
    """

    @property
    @abstractmethod
    def attitudes(self) -> tuple[Attitude, ...]:
        """The quaternions, in the order of the states."""

    @property
    @abstractmethod
    def deviations(self) -> tuple[Signal, ...]:
        """The states of its linear models."""

    @cached_property
    def small(self) -> Deviations:
        """How deviations follow from states."""
        return Deviations(self.attitudes, self.nx)

    @property
    def attitude_states(self) -> tuple[str, ...]:
        return tuple(s.name for a in self.attitudes for s in self.states[a.quaternion])

    def check_state(self, x: Array) -> None:
        """Raise ValueError where a quaternion of x (..., nx) is not of unit length. Quaternions are dimensionless."""
        for a in self.attitudes:
            norm = np.atleast_1d(np.linalg.norm(x[..., a.quaternion], axis=-1))
            worst = float(norm[np.argmax(np.abs(norm - 1))])
            if not abs(worst - 1) <= UNIT:
                raise ValueError(
                    f"{type(self).__name__}.x: the quaternion{a.of} has norm {worst:.6g}, must be 1; see `state`"
                )

    def consistent(self, x: Array) -> Array:
        """x (..., nx) with unit quaternions: no turn where one is zero.

        Quaternions are dimensionless. ValueError for another shape.
        """
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
        """x (nx,) with these states by name, in `values` or as keywords; the others zero, nothing turned where no
        quaternion is named."""
        owner = f"{type(self).__name__}.state"
        x = np.array(self.rest_state)
        given = {} if values is None else require_by_name(f"{owner}.values", values)
        for name, value in (given | require_by_name(owner, named)).items():
            x[index(self.states, name, "state")] = value
        return x

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
            self.check_state(one_state(self, x0))
            return super().linearize(x0, u0, w=w, p=p, t=t)
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
        """As of any plant, in this one's deviations. x (nx,), P (n, n), after (nx,), t [s]."""
        own = super().jump_map(x, P, after=after, p=p, t=t)
        return linear.jump(self, x, after, own, t) if self.attitudes else own

    def feedback_model(self, x0: Any, u0: Any = None, *, p: Any = None) -> LinearModel:
        """The linear model in signals: attitude outputs for quaternions, angular velocities for the rates of turns.

        Where an attitude turns at (x0, u0) it is left out; ValueError where the rest feels it.
        """
        return feedback_model(self, x0, u0, p) if self.attitudes else super().feedback_model(x0, u0, p=p)

"""The states, inputs and joints of a tree, from its joints and from what comes after their coordinates."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from pliant.plants.attitudes.turning_plant import TurningPlant
from pliant.plants.core.signals import Joint as Driven
from pliant.plants.core.signals import Signal
from pliant.plants.integration.inverse_dynamics import InverseDynamics
from pliant.plants.multibody_parts.joint import SINGLE, Joint

from .floating import Floating
from .freedoms import TURNS, Freedom, Slot, coordinates, ends, freedoms, motor_of, slots


@dataclass(frozen=True, kw_only=True)
class TreeJoints(TurningPlant):
    """q = [joints, motors, elastic coordinates] and the speeds of these."""

    @property
    @abstractmethod
    def moving(self) -> tuple[Joint, ...]:
        """Joints with coordinates, in order, those of a base that moves first."""

    @property
    @abstractmethod
    def motors(self) -> tuple[int, ...]:
        """Which of them have a motor behind an elastic gear."""

    @property
    @abstractmethod
    def beyond(self) -> tuple[Signal, ...]:
        """Coordinates of motors and of bodies that bend."""

    @property
    @abstractmethod
    def thrusts(self) -> tuple[Signal, ...]:
        """Inputs that act on no joint: thrusters, after the others."""

    @property
    @abstractmethod
    def floats(self) -> bool:
        """Whether the first joint is that of a free base."""

    @cached_property
    def slots(self) -> tuple[Slot, ...]:
        """Where the coordinates and speeds of the joints are."""
        return slots(list(self.moving))

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        return (*(s for joint in self.moving for s in coordinates(joint)), *self.beyond)

    @cached_property
    def freedoms(self) -> tuple[Freedom, ...]:
        """Of all joints, then of the motors."""
        own = (f for joint in self.moving for f in freedoms(joint))
        return (*own, *(motor_of(self.moving[i]) for i in self.motors))

    @property
    def speeds(self) -> tuple[Signal, ...]:
        own = [f.rate for joint in self.moving for f in freedoms(joint)]
        return (*own, *(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in self.beyond))

    @cached_property
    def turns(self) -> tuple[tuple[str, int, int], ...]:
        """Of each quaternion: its name, where it begins in q, where its rates begin in v."""
        return tuple((s.joint.name, *s.turn) for s in self.slots if s.turn is not None)

    @property
    def held(self) -> dict[str, float]:
        """Place and attitude of a free base. In [m] and [-]."""
        if not self.floats:
            return {}
        return {s.name: float(k == TURNS["free"]) for k, s in enumerate(coordinates(self.moving[0]))}

    @cached_property
    def _inputs(self) -> tuple[tuple[Signal, int], ...]:
        """(input, speed that it acts on)."""
        found, n = [], ends(self.slots)[1]
        for i, (joint, _, v) in enumerate(self.slots):
            if i in self.motors:
                at = n + self.motors.index(i)
                found.append((self.freedoms[at].force, at))
            elif joint.drive != "none":
                given = joint.drive == "acceleration"
                own = enumerate(self.freedoms[v : v + len(freedoms(joint))], v)
                found += [(f.acceleration if given else f.force, at) for at, f in own]
        return tuple(found)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        return (*(signal for signal, _ in self._inputs), *self.thrusts)

    @property
    def driven(self) -> dict[int, int]:
        given = {s.v + k for s in self.slots if s.joint.drive == "acceleration" for k in range(len(freedoms(s.joint)))}
        return {v: k for k, (_, v) in enumerate(self._inputs) if v in given}

    @property
    def joints(self) -> tuple[Driven, ...]:
        ranges = {slot.v: _range(slot.joint) for slot in self.slots if slot.joint.kind in SINGLE}
        return tuple(
            Driven(s.name, self.freedoms[v].place.name, self.freedoms[v].rate.name, **ranges.get(v, {}))
            for s, v in self._inputs
        )

    def told(self, q: ca.SX) -> list[ca.SX]:
        """What is told of each freedom: its coordinate, or of a turn twice the quaternion's vector."""
        found = list[ca.SX]()
        for slot in self.slots:
            n = len(freedoms(slot.joint))
            shifts = n if slot.turn is None else n - 3
            found += [q[slot.q + k] for k in range(shifts)]
            if slot.turn is not None:
                found += [2 * q[slot.turn[0] + 1 + k] for k in range(3)]
        first = ends(self.slots)[0]
        return found + [q[first + k] for k in range(len(self.motors))]

    def rest_to_rest(
        self, begin: np.ndarray, end: np.ndarray, time: float, *, profile: str = "minimum-jerk"
    ) -> Callable[[float], np.ndarray]:
        """As of every plant; a free base moves as its momentum, which is none, says. begin, end (nx,); time [s]."""
        return (Floating if self.floats else InverseDynamics)(self, begin, end, time, profile)

    @property
    def measured(self) -> list[int]:
        """The freedoms in the order in which their places are told: those without an input first."""
        driven = {v for _, v in self._inputs}
        passive = [v for v in range(ends(self.slots)[1]) if v not in driven]
        return [*passive, *sorted(driven)]


def _range(joint: Joint) -> dict[str, float]:
    """How far the coordinate may go, and the largest torque of a joint whose motor is stiff, where they are told."""
    stiff = joint.elastic is None and joint.drive == "torque"
    told = {"lower": joint.lower, "upper": joint.upper, "effort": joint.effort if stiff else None}
    return {name: value for name, value in told.items() if value is not None}

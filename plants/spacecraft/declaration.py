"""What a spacecraft is: its bodies, what acts on it from outside, and the names and places of its signals."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.attitudes.attitude_plant import AttitudePlant
from pliant.plants.attitudes.deviations import Attitude
from pliant.plants.core.argument_gates import require_all
from pliant.plants.core.parameters import flag, part, require_choice, validate
from pliant.plants.core.quaternions import matrix
from pliant.plants.core.signals import Signal
from pliant.plants.dynamics.arguments import line_points, one_state
from pliant.plants.modal_data.deformed_body import constant
from pliant.plants.modal_data.driven_families import before_the_last, left_out
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.environment import Environment
from pliant.plants.spacecraft_parts.hub import Hub

from .layout import Layout

KINEMATICS = ("rigid", "linear", "stiffened")
AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class SpacecraftDeclaration(AttitudePlant):
    """A hub and the appendages hinged to it; `FlexibleSpacecraft` adds their equations of motion."""

    hub: Hub = part(Hub)
    appendages: tuple[Appendage, ...] = ()
    kinematics: str = "stiffened"
    translation: bool = flag(True)  # False: position and velocity are no states; the hub still moves with the loads
    environment: Environment = part(Environment, default_factory=Environment)

    def __post_init__(self) -> None:
        validate(self)
        require_choice("FlexibleSpacecraft", "kinematics", self.kinematics, KINEMATICS)
        appendages = require_all("FlexibleSpacecraft.appendages", self.appendages, Appendage)
        object.__setattr__(self, "appendages", appendages)

    @cached_property
    def mode_counts(self) -> tuple[int, ...]:
        """Elastic coordinates of each appendage."""
        own = self.nominal
        assert isinstance(own, SpacecraftDeclaration)
        return tuple(0 if self.kinematics == "rigid" else a.data.n for a in own.appendages)

    @cached_property
    def layout(self) -> Layout:
        """Where states and inputs stand in x and u."""
        own = self.nominal
        assert isinstance(own, SpacecraftDeclaration)
        return Layout.of(
            [a.hinge.n for a in own.appendages],
            own.mode_counts,
            [0 if a.hinge.drive == "free" else a.hinge.n for a in own.appendages],
            wheels=len(own.hub.wheels),
            hub_inputs=own.hub.inputs,
            translation=own.translation,
        )

    @cached_property
    def attitudes(self) -> tuple[Attitude, ...]:
        """The hub's."""
        return (Attitude("", self.layout.quaternion.start, self.layout.omega.start),)

    @cached_property
    def deviations(self) -> tuple[Signal, ...]:
        """The states of its linear models, those of the paper: y = [p, q, hinge angles, eta] and dy/dt, then wheel
        momenta; p is the change of position in reference axes, q the small turn of the hub in nominal hub axes.
        """
        place = tuple(Signal(f"p_{c}", "m") for c in AXES if self.translation)
        y = (*place, *(Signal(f"q_{c}", "rad") for c in AXES), *self.coordinates)
        return y + tuple(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in y) + self.states[self.layout.wheels]

    def nominal_data(self, i: int) -> ModalData:
        """Modal data of appendage i, those in use."""
        own = self.nominal
        assert isinstance(own, SpacecraftDeclaration)
        return own.appendages[i].data

    @property
    def coordinates_slice(self) -> slice:
        """Position, attitude, hinge angles, elastic coordinates."""
        return slice(0, self.layout.quaternion.stop + len(self.coordinates))

    @cached_property
    def coordinates(self) -> tuple[Signal, ...]:
        """Hinge angles, then elastic coordinates."""
        named = list(enumerate(self.appendages, start=1))
        angles = [Signal(f"hinge{i}_{j + 1}", "rad") for i, a in named for j in range(a.hinge.n)]
        modes = [Signal(f"eta{i}_{k + 1}", "m") for (i, _), n in zip(named, self.mode_counts) for k in range(n)]
        return (*angles, *modes)

    @cached_property
    def states(self) -> tuple[Signal, ...]:
        moved = self.translation
        position = tuple(Signal(f"position_{c}", "m") for c in AXES if moved)
        velocity = tuple(Signal(f"velocity_{c}", "m/s") for c in AXES if moved)
        quaternion = tuple(Signal(f"quaternion_{k}", "1") for k in range(4))
        body = tuple(Signal(f"rate_{c}", "rad/s") for c in AXES)
        speeds = tuple(Signal(f"{s.name}_rate", f"{s.unit}/s") for s in self.coordinates)
        wheels = tuple(Signal(f"wheel{k + 1}_momentum", "N m s") for k in range(len(self.hub.wheels)))
        return position + quaternion + self.coordinates + velocity + body + speeds + wheels

    @cached_property
    def inputs(self) -> tuple[Signal, ...]:
        found = [Signal(f"wheel{k + 1}_torque", "N m") for k in range(len(self.hub.wheels))]
        found += [Signal(f"thrust{k + 1}", "N") for k in range(len(self.hub.thrusters))]
        found = found or [Signal(f"torque_{c}", "N m") for c in AXES]
        kinds = {"torque": ("torque", "N m"), "angle": ("command", "rad"), "motion": ("acceleration", "rad/s^2")}
        for i, a in enumerate(self.appendages, start=1):
            if a.hinge.drive != "free":
                word, unit = kinds[a.hinge.drive]
                found += [Signal(f"hinge{i}_{j + 1}_{word}", unit) for j in range(a.hinge.n)]
        return tuple(found)

    @cached_property
    def disturbances(self) -> tuple[Signal, ...]:
        """Force on the hub's mass centre in reference axes, torque in hub axes."""
        return tuple(Signal(f"force_{c}", "N") for c in AXES) + tuple(Signal(f"disturbance_{c}", "N m") for c in AXES)

    @cached_property
    def outputs(self) -> tuple[Signal, ...]:
        found = [Signal(f"attitude_{c}", "1") for c in AXES] + [Signal(f"body_rate_{c}", "rad/s") for c in AXES]
        for i in range(1, len(self.appendages) + 1):
            found += [Signal(f"tip{i}_{c}", "m") for c in AXES]
        return tuple(found)

    @property
    def label(self) -> str:
        many, modes = len(self.appendages), sum(self.mode_counts)
        bodies = f"{many} appendage{'s' * (many != 1)}"
        place = "" if self.translation else ", rotation only"
        if self.kinematics == "rigid":
            return f"rigid, {bodies}{place}"
        return f"{self.kinematics}, {bodies}, {modes} mode{'s' * (modes != 1)}{place}"

    def ladder(self) -> tuple[Self, ...]:
        """Rigid, then one mode of each appendage, its own, and all that its modal data hold; linear and stiffened."""
        few = tuple(dataclasses.replace(a, modes=None, body=a.data.slowest(min(1, a.data.n))) for a in self.appendages)
        all_modes = tuple(
            dataclasses.replace(a, modes=None) if isinstance(a.body, ModalData) else a for a in self.appendages
        )
        sets = [few] if any(a.data.n > 1 for a in self.appendages) else []
        sets.append(self.appendages)
        if any(a.data.n > b.data.n for a, b in zip(all_modes, self.appendages)):
            sets.append(all_modes)
        steps = [dataclasses.replace(self, kinematics="rigid")]
        for kinematics in ("linear", "stiffened"):
            steps += [dataclasses.replace(self, kinematics=kinematics, appendages=bodies) for bodies in sets]
        return tuple(steps)

    def physics(self, more: int = 0) -> Self:
        """Stiffened, with `more` and one more mode of each appendage that is a beam, and all of modal data.

        By itself (`more` = 0) those of modal data but the last about each axis: what it is worth is the size of what
        the data leave out, which no model can tell.
        """
        bodies = tuple(_richer(a, more + 1) for a in self.appendages)
        return dataclasses.replace(self, kinematics="stiffened", appendages=bodies)

    @property
    def left_out(self) -> float:
        data = [a.body for a in self.appendages if isinstance(a.body, ModalData)]
        return max((left_out(body, turned=not self.translation) for body in data), default=super().left_out)

    @property
    def effects(self) -> dict[str, bool]:
        bends = self.kinematics != "rigid" and sum(self.mode_counts) > 0
        return {"bending": bends, "shortening of the bent appendages": bends and self.kinematics == "stiffened"}

    def _lacking(self, effect: str) -> Self:
        kinds = {"bending": "rigid", "shortening of the bent appendages": "linear"}
        return dataclasses.replace(self, kinematics=kinds[effect])

    @property
    def unmodelled(self) -> tuple[str, ...]:
        return "exact rotations of the appendages", "modes that their modal data leave out", "fuel that moves"

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        at, found = self.layout, [2 * x[self.layout.quaternion][1:], x[self.layout.omega]]
        for i, a in enumerate(self.appendages):
            eta = x[at.modes[i]]
            found.append(constant(a.data.tip_shapes[: eta.shape[0]].T) @ eta if eta.shape[0] else ca.SX.zeros(3))
        return ca.vertcat(*found)

    def turn(self, x: Any) -> np.ndarray:
        """R (3, 3), hub axes to reference axes, at a state x (nx,)."""
        return np.array(ca.DM(matrix(ca.SX(ca.DM(one_state(self, x)[self.layout.quaternion])))))

    def outline(self, x: np.ndarray, points: int = 30) -> list[np.ndarray]:
        """Lines (m, 3) [m] of the appendages in reference axes at a state x (nx,), for drawing."""
        x, at, lines = one_state(self, x), self.layout, []
        line_points(self, points)
        R = self.turn(x)
        origin = x[at.position] if self.translation else np.zeros(3)
        for i, body in enumerate(self.appendages):
            C = np.array(ca.DM(ca.densify(ca.evalf(body.turn(ca.SX(ca.DM(x[at.hinges[i]])))))))
            eta, data = x[at.modes[i]], body.data
            bent = data.outline + np.einsum("k,kpi->pi", eta, data.outline_shapes[: len(eta)])
            lines.append(origin + (np.asarray(body.position, dtype=float) + bent @ C.T) @ R.T)
        return lines

    @abstractmethod
    def residual(self, x: Any, a: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> np.ndarray:
        """M a + bias - loads (6 + n,) in [N] and [N m] at any accelerations a (6 + n,)."""


def _richer(appendage: Appendage, more: int) -> Appendage:
    """The modes of modal data, all but the last where `more` is 1; or `more` of a beam."""
    if isinstance(appendage.body, ModalData):
        data = appendage.body if more > 1 else appendage.body.slowest(before_the_last(appendage.body))
        return dataclasses.replace(appendage, modes=None, body=data)
    own = 1 if appendage.modes is None else appendage.modes
    if isinstance(own, int):
        return dataclasses.replace(appendage, modes=own + more)
    return dataclasses.replace(appendage, modes=(own[0] + more, own[1] + more))

"""What the library asks of a plant, answered for a spacecraft: joints, sensors, attitude, what it does not feel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pliant.plants.core.signals import Joint, Sensed, Unfelt, names

from .declaration import AXES, SpacecraftDeclaration
from .eigenaxis import slew


@dataclass(frozen=True, kw_only=True)
class SpacecraftContract(SpacecraftDeclaration):
    """See `PlantContract`: each answer of the plant's that its signals and equations do not give by themselves."""

    @property
    def planar_chain(self) -> str:
        return "a free hub in space with flexible appendages, of modal data or not, is no planar chain of beams"

    @cached_property
    def rates(self) -> dict[str, str]:
        return {s.name: f"{s.name}_rate" for s in self.coordinates}

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """Of its linear models too."""
        at, n = self.layout, (len(self.deviations) - len(self.hub.wheels)) // 2
        own = (*names(self.states[at.velocity]), *names(self.states[at.omega]))
        return (*own, *names(self.deviations[n : 2 * n]))

    @cached_property
    def prescribed(self) -> tuple[str, ...]:
        """Names of coordinates that are driven as given."""
        slots = zip(self.appendages, self.layout.hinges, strict=True)
        return tuple(s.name for a, at in slots if a.hinge.drive == "motion" for s in self.states[at])

    @property
    def lockable(self) -> tuple[str, ...]:
        """None: what a goal names turns the whole, which stays free."""
        return ()

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """A torque, or a wheel about a hub axis, and the attitude about that axis; a hinge's input and its angle."""
        at, found = self.layout, []
        for s, axis in zip(self.inputs[at.hub_inputs], self.hub.axes, strict=True):
            if axis is not None:
                found.append(Joint(s.name, f"attitude_{axis}", f"body_rate_{axis}"))
        for inputs, hinges in zip(at.hinge_inputs, at.hinges, strict=True):
            for s, angle in zip(self.inputs[inputs], names(self.states[hinges])):
                found.append(Joint(s.name, angle, self.rates[angle]))
        return tuple(found)

    @property
    def shared_joints(self) -> tuple[Joint, ...]:
        """The attitude, where wheels about any three or more directions are all the inputs there are."""
        axes = np.array([wheel.axis for wheel in self.hub.wheels]).reshape(-1, 3)
        if len(axes) != len(self.inputs) or np.linalg.matrix_rank(axes) < 3:
            return ()
        return tuple(Joint("", f"attitude_{c}", f"body_rate_{c}") for c in "xyz")

    def sensors(self) -> tuple[Sensed, ...]:
        """Star tracker, gyro, tachometers of the wheels, encoders of the hinges; not the place."""
        stars = (Sensed("star tracker", name, "rad") for name in self.attitude_outputs)
        gyros = (Sensed("fibre-optic gyro", s.name) for s in self.outputs[3:6])
        wheels = zip(self.states[self.layout.wheels], self.hub.wheels, strict=True)
        speeds = (Sensed("tachometer", s.name, scale=float(wheel.inertia)) for s, wheel in wheels)
        angles = (Sensed("encoder", s.name) for at in self.layout.hinges for s in self.states[at])
        return (*stars, *gyros, *speeds, *angles)

    @property
    def tips(self) -> tuple[str, ...]:
        """The outputs that are components of the tips' deflections."""
        return names(self.outputs[6:])

    @property
    def attitude_outputs(self) -> tuple[str, ...]:
        return names(self.outputs[:3])

    @property
    def unfelt(self) -> Unfelt:
        """Place and attitude, in the plant's states or in deviations; hinges in given motion; wheels at a speed."""
        place = (*(f"p_{c}" for c in AXES), *names(self.states[self.layout.position]))
        given = (*self.prescribed, *(self.rates[name] for name in self.prescribed))
        turn = tuple(f"q_{c}" for c in AXES)
        return Unfelt((place, self.attitude_states, turn), given, names(self.states[self.layout.wheels]))

    @property
    def drawn_as(self) -> str:
        return "spacecraft"

    def rest_to_rest(
        self, begin: np.ndarray, end: np.ndarray, time: float, *, profile: str = "minimum-jerk"
    ) -> Callable[[float], np.ndarray]:
        """A turn about one axis fixed in the body (an eigenaxis slew), hinges as at `begin`; see `eigenaxis`.

        begin, end (nx,); time [s].
        """
        return slew(self, begin, end, time, profile)

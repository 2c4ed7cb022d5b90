"""What a tree of bodies is: its parameters and its signals."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from pliant.plants.beams.payload import Payload
from pliant.plants.core.argument_gates import as_tuple, require_all, require_choice, require_names, shown
from pliant.plants.core.parameters import part, quantity, validate
from pliant.plants.core.signals import Joint as Driven
from pliant.plants.core.signals import Signal
from pliant.plants.dynamics.lagrangian import LagrangianPlant
from pliant.plants.elastic_bodies.elastic_body import ElasticBody
from pliant.plants.elastic_bodies.modal_body import place_on
from pliant.plants.elastic_bodies.of_body import coordinates_of, elastic_body, readings_of
from pliant.plants.multibody_parts.joint import Frame, Joint, name_gate, place_gate
from pliant.plants.multibody_parts.tree_body import TreeBody

from .layout import Layout, layout
from .measurements import AXES, DEVICES, signals

KINEMATICS = ("rigid", "linear", "stiffened", "strain")
BASES = ("polynomial", "clamped-free")


def in_tree(name: str, given: tuple[TreeBody, ...], root: str) -> tuple[TreeBody, ...]:
    """One body at least, parents before children, each name once; the parent "" becomes the body before."""
    bodies = list(given)
    if not bodies:
        raise ValueError(f"{name} = () must be one body at least")
    known, joints = [root], list[str]()
    for k, body in enumerate(bodies):
        parent = body.parent or known[-1]
        if body.name in known or body.joint.name in joints:
            word = body.name if body.name in known else body.joint.name
            raise ValueError(f"{name}[{k}] = {word!r} must have a name of its own, as its joint must")
        if parent not in known:
            raise ValueError(
                f"{name}[{k}].parent = {parent!r} of body {body.name!r} must be a body before it: {', '.join(known)}"
            )
        bodies[k] = dataclasses.replace(body, parent=parent)
        known.append(body.name)
        joints.append(body.joint.name)
    return tuple(bodies)


def frames_gate(name: str, value: Any) -> tuple[Frame, ...]:
    """A tuple of frames."""
    return require_all(name, value, Frame)


def loads_gate(name: str, value: Any) -> tuple[str, ...]:
    """Names of frames."""
    return require_names(name, as_tuple(name, value))


def devices_gate(name: str, value: Any) -> tuple[str, ...]:
    """Names of devices."""
    return require_names(name, as_tuple(name, value), tuple(DEVICES), "device")


@dataclass(frozen=True, kw_only=True)
class TreeDeclaration(LagrangianPlant):
    """Bodies, places and fidelity; `FlexibleTree` adds their equations."""

    bodies: tuple[TreeBody, ...] = field(metadata={"gate": lambda name, value: require_all(name, value, TreeBody)})
    frames: tuple[Frame, ...] = field(default=(), metadata={"gate": frames_gate})
    tip: str = field(default="", metadata={"gate": place_gate})
    payload: Payload = part(Payload, default_factory=Payload)
    gravity: Any = quantity("m/s^2", "finite", (0.0, 0.0, -9.81), shape=(3,))
    loads: tuple[str, ...] = field(default=("tip",), metadata={"gate": loads_gate})
    devices: tuple[str, ...] = field(default=(), metadata={"gate": devices_gate})
    kinematics: str = "stiffened"
    basis: str = "polynomial"
    base: str = "fixed"
    root: str = field(default="base", metadata={"gate": name_gate})  # what the base is called as a parent

    def __post_init__(self) -> None:
        validate(self)
        owner = type(self).__name__
        for name, choices in (("kinematics", KINEMATICS), ("basis", BASES), ("base", ("fixed",))):
            require_choice(owner, name, getattr(self, name), choices)
        object.__setattr__(self, "bodies", in_tree(f"{owner}.bodies", self.bodies, self.root))
        known = {self.root, *(b.name for b in self.bodies)}
        taken = {"tip"}
        for k, frame in enumerate(self.frames):
            if frame.body not in known:
                raise ValueError(
                    f"{owner}.frames[{k}].body = {frame.body!r} of frame {frame.name!r} must be one of "
                    f"{', '.join(sorted(known))}"
                )
            if frame.name in taken:
                raise ValueError(
                    f"{owner}.frames[{k}].name = {frame.name!r} must be a name of its own, other than 'tip'"
                )
            taken.add(frame.name)
        if self.tip and self.tip not in known | taken:
            raise ValueError(
                f"{owner}.tip = {self.tip!r} must be a body or a frame: {', '.join(sorted(known | taken))}"
            )
        for k, place in enumerate(self.loads):
            if place not in taken:
                raise ValueError(f"{owner}.loads[{k}] = {place!r} must be one of {', '.join(sorted(taken))}")
        if not any(b.joint.moves or sum(self.counts(b)) for b in self.bodies):
            raise ValueError(
                f"{owner}.bodies = {shown(tuple(b.name for b in self.bodies))} must have a joint that moves"
            )
        modal = {b.name: b.modal for b in self.bodies if b.modal is not None}
        hung = [(b.parent, b.joint) for b in self.bodies] + [(f.body, f) for f in self.frames]
        for name, part in hung:
            if name in modal:
                place_on(modal[name], name, part)
        self._check_names(owner)

    def _check_names(self, owner: str) -> None:
        words = [s.name for s in self.coordinates]
        twice = next((w for k, w in enumerate(words) if w in words[:k]), None)
        if twice is not None:
            raise ValueError(f"{owner}.bodies give two coordinates the name {twice!r}; joints and bodies must differ")

    def counts(self, body: TreeBody) -> tuple[int, ...]:
        """Shapes of a body's beam by family in this fidelity, or the number of its modes."""
        if body.modal is not None:
            return (0,) if self.kinematics == "rigid" else (int(body.modal_modes or 0),)
        return (0, 0, 0, 0) if body.beam is None or self.kinematics == "rigid" else body.modes

    def _beam(self, body: TreeBody) -> ElasticBody | None:
        return elastic_body(body, self.counts(body), self.basis, self.kinematics)

    @cached_property
    def tip_frame(self) -> Frame:
        """Where the payload is held."""
        for frame in self.frames:
            if frame.name == self.tip:
                return dataclasses.replace(frame, name="tip")
        return Frame(name="tip", body=self.tip or self.bodies[-1].name)

    @cached_property
    def tree(self) -> Layout:
        """The nodes of the recursion."""
        frames = [self.tip_frame, *self.frames]
        return layout([(b, b.parent) for b in self.bodies], self.payload, self.tip_frame, frames, self._beam, self.root)

    @cached_property
    def moving(self) -> tuple[Joint, ...]:
        """Joints with a coordinate, in order."""
        return tuple(b.joint for b in self.bodies if b.joint.moves)

    @cached_property
    def motors(self) -> tuple[int, ...]:
        """Which of them have a motor behind an elastic gear."""
        return tuple(i for i, joint in enumerate(self.moving) if joint.elastic is not None)

    @property
    def flexible(self) -> tuple[TreeBody, ...]:
        """Bodies with elastic coordinates."""
        return tuple(b for b in self.bodies if sum(self.counts(b)))

    @property
    def slender(self) -> tuple[TreeBody, ...]:
        """Bodies that bend, in this fidelity or not: what is measured of all of them is the same."""
        return tuple(b for b in self.bodies if b.bends)

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        joints = [Signal(j.name, "m" if j.slides else "rad") for j in self.moving]
        motors = [Signal(f"{self.moving[i].name}_motor", "rad") for i in self.motors]
        bent = [Signal(f"{b.name}_{s.name}", s.unit) for b in self.flexible for s in coordinates_of(b, self.counts(b))]
        return (*joints, *motors, *bent)

    @cached_property
    def _inputs(self) -> tuple[tuple[Signal, int], ...]:
        """(input, coordinate that it acts on)."""
        found = []
        for i, joint in enumerate(self.moving):
            if i in self.motors:
                at = len(self.moving) + self.motors.index(i)
                found.append((Signal(f"{joint.name}_motor_torque", "N m"), at))
            elif joint.drive == "torque":
                word, unit = ("force", "N") if joint.slides else ("torque", "N m")
                found.append((Signal(f"{joint.name}_{word}", unit), i))
            elif joint.drive == "acceleration":
                found.append((Signal(f"{joint.name}_acceleration", "m/s^2" if joint.slides else "rad/s^2"), i))
        return tuple(found)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        return tuple(signal for signal, _ in self._inputs)

    @property
    def driven(self) -> dict[int, int]:
        given = {i for i, joint in enumerate(self.moving) if joint.drive == "acceleration"}
        return {i: k for k, (_, i) in enumerate(self._inputs) if i in given}

    @property
    def joints(self) -> tuple[Driven, ...]:
        pairs = list(self.rates.items())
        return tuple(Driven(signal.name, *pairs[i]) for signal, i in self._inputs)

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        kinds = (("force", "N"), ("torque", "N m"))
        return tuple(Signal(f"{p}_{word}_{axis}", unit) for p in self.loads for word, unit in kinds for axis in AXES)

    @property
    def outputs(self) -> tuple[Signal, ...]:
        measured = [s for s in self.coordinates if s.name in {j.position for j in self.joints}]
        passive = [s for s in self.coordinates[: len(self.moving)] if s not in measured]
        found = [*passive, *measured]
        for b in self.slender:
            found += readings_of(b)
        for place in self.places:
            found += [Signal(f"{place}_{axis}", "m") for axis in AXES]
            found += [Signal(f"{place}_{axis}_rate", "m/s") for axis in AXES]
        return (*found, *signals(self.devices, self.places))

    @property
    def places(self) -> tuple[str, ...]:
        """The tip and the frames: where positions are told and devices stand."""
        return ("tip", *(f.name for f in self.frames))

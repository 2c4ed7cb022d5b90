"""What a tree of bodies is: its parameters and its signals."""

from __future__ import annotations

import dataclasses
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from pliant.plants.beams.payload import Payload
from pliant.plants.core.argument_gates import as_tuple, require_all, require_choice, require_names, shown
from pliant.plants.core.parameters import part, quantity, validate
from pliant.plants.core.signals import Signal
from pliant.plants.elastic_bodies.elastic_body import ElasticBody
from pliant.plants.elastic_bodies.of_body import check_nodes, coordinates_of, elastic_body, readings_of
from pliant.plants.multibody_joints.bases import FREEDOMS, base_bodies, check_platform
from pliant.plants.multibody_joints.bases import KINDS as BASES_OF_TREES
from pliant.plants.multibody_joints.carried import check_carried
from pliant.plants.multibody_joints.tree_joints import TreeJoints
from pliant.plants.multibody_parts.joint import Frame, FrameThruster, Joint, name_gate, place_gate
from pliant.plants.multibody_parts.tree_body import TreeBody
from pliant.plants.multibody_recursion.layout import Layout, layout

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


def thrusters_gate(name: str, value: Any) -> tuple[FrameThruster, ...]:
    """A tuple of thrusters."""
    return require_all(name, value, FrameThruster)


def words_gate(name: str, value: Any) -> tuple[str, ...]:
    """Sentences."""
    return require_names(name, as_tuple(name, value))


def devices_gate(name: str, value: Any) -> tuple[str, ...]:
    """Names of devices."""
    return require_names(name, as_tuple(name, value), tuple(DEVICES), "device")


def freedoms_gate(name: str, value: Any) -> tuple[str, ...]:
    """Names of a base's freedoms, one at least."""
    found = require_names(name, as_tuple(name, value), FREEDOMS, "freedom")
    if not found:
        raise ValueError(f"{name} = () must name one freedom at least: {', '.join(FREEDOMS)}")
    return tuple(f for f in FREEDOMS if f in found)


def check_thrusters(name: str, thrusters: tuple[FrameThruster, ...], known: set[str]) -> None:
    """ValueError where one stands at no frame, or two at the same."""
    frames = [one.frame for one in thrusters]
    for k, frame in enumerate(frames):
        if frame not in known or frame in frames[:k]:
            raise ValueError(
                f"{name}[{k}].frame = {frame!r} must be one of {', '.join(sorted(known))}, one thruster each"
            )


@dataclass(frozen=True, kw_only=True)
class TreeDeclaration(TreeJoints):
    """Bodies, places and fidelity; `FlexibleTree` adds their equations."""

    bodies: tuple[TreeBody, ...] = field(metadata={"gate": lambda name, value: require_all(name, value, TreeBody)})
    frames: tuple[Frame, ...] = field(default=(), metadata={"gate": frames_gate})
    tip: str = field(default="", metadata={"gate": place_gate})
    payload: Payload = part(Payload, default_factory=Payload)
    gravity: Any = quantity("m/s^2", "finite", (0.0, 0.0, -9.81), shape=(3,))
    loads: tuple[str, ...] = field(default=("tip",), metadata={"gate": loads_gate})
    thrusters: tuple[FrameThruster, ...] = field(default=(), metadata={"gate": thrusters_gate})
    devices: tuple[str, ...] = field(default=(), metadata={"gate": devices_gate})
    kinematics: str = "stiffened"
    basis: str = "polynomial"
    base: str = "fixed"
    platform: Payload = part(Payload, default_factory=Payload)  # the base itself, where it is free or driven
    base_freedoms: tuple[str, ...] = field(default=FREEDOMS, metadata={"gate": freedoms_gate})  # of a driven base
    root: str = field(default="base", metadata={"gate": name_gate})  # what the base is called as a parent
    repairs: tuple[str, ...] = field(default=(), metadata={"gate": words_gate})  # of inertias in its file, in words

    def __post_init__(self) -> None:
        validate(self)
        owner = type(self).__name__
        for name, choices in (("kinematics", KINEMATICS), ("basis", BASES), ("base", BASES_OF_TREES)):
            require_choice(owner, name, getattr(self, name), choices)
        object.__setattr__(self, "bodies", in_tree(f"{owner}.bodies", self.bodies, self.root))
        if self.base == "free":
            check_platform(owner, self.root, self.platform, self.bodies)
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
        check_thrusters(f"{owner}.thrusters", self.thrusters, taken)
        if self.base == "fixed" and not any(b.joint.moves or sum(self.counts(b)) for b in self.bodies):
            raise ValueError(
                f"{owner}.bodies = {shown(tuple(b.name for b in self.bodies))} must have a joint that moves"
            )
        check_nodes(self.bodies, self.frames)
        check_carried(owner, self.bodies, self.payload, self.tip_frame.body)
        self._check_names(owner)

    def _check_names(self, owner: str) -> None:
        for kind, found in (("states", self.states), ("inputs", self.inputs), ("outputs", self.outputs)):
            twice = [name for name, count in Counter(s.name for s in found).items() if count > 1]
            if twice:
                raise ValueError(
                    f"{owner} gives two {kind} the name {twice[0]!r}: names of joints, bodies and frames must differ"
                )

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
        parts = [(b, b.parent) for b in (*self.ground, *self.bodies)]
        return layout(parts, self.payload, self.tip_frame, frames, self._beam, self.root)

    @property
    def thrusts(self) -> tuple[Signal, ...]:
        return tuple(Signal(f"{one.frame}_thrust", "N") for one in self.thrusters)

    @property
    def floats(self) -> bool:
        return self.base == "free"

    @cached_property
    def ground(self) -> tuple[TreeBody, ...]:
        """What a base that moves hangs on, one after the other, itself last."""
        return base_bodies(self.base, self.root, self.platform, self.base_freedoms)

    @cached_property
    def moving(self) -> tuple[Joint, ...]:
        """Joints with coordinates, in order, those of a base that moves first."""
        return tuple(b.joint for b in (*self.ground, *self.bodies) if b.joint.moves)

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
    def beyond(self) -> tuple[Signal, ...]:
        """Coordinates of motors and of bodies that bend."""
        motors = [Signal(f"{self.moving[i].name}_motor", "rad") for i in self.motors]
        bent = [Signal(f"{b.name}_{s.name}", s.unit) for b in self.flexible for s in coordinates_of(b, self.counts(b))]
        return (*motors, *bent)

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        kinds = (("force", "N"), ("torque", "N m"))
        return tuple(Signal(f"{p}_{word}_{axis}", unit) for p in self.loads for word, unit in kinds for axis in AXES)

    @property
    def outputs(self) -> tuple[Signal, ...]:
        found = [self.freedoms[v].place for v in self.measured]
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

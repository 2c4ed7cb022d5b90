"""Coordinates, speeds and inputs of the kinds of joints.

A turn in space is a unit quaternion, scalar first, from the axes beyond to those before; its speeds are the angular
velocity relative to the parent, in the axes beyond, as the rates of a spacecraft's hub. So such joints have one
coordinate more than speeds: d(quaternion)/dt = Xi omega / 2. Shifts are those of the axes before, and their rates.
"""

from __future__ import annotations

from typing import NamedTuple

from pliant.plants.core.signals import Signal, per_second
from pliant.plants.multibody_parts.joint import Joint

AXES = ("x", "y", "z")
TURNS = {"spherical": 0, "free": 3}  # where among the coordinates, and the speeds, of the joint its turn begins
SHIFTS = {"planar": 2, "free": 3}  # of joints that turn as well: how many come first


class Freedom(NamedTuple):
    """One speed of a joint: what is told of its place, its rate, and its inputs: a force or torque, or where the motion
    is given the acceleration.
    """

    place: Signal  # a coordinate, or a component of the attitude
    rate: Signal
    force: Signal
    acceleration: Signal


def _freedom(place: Signal, rate: Signal, name: str, ending: str = "") -> Freedom:
    """Its inputs are called after the joint, with an `ending` where that has several."""
    kind, unit = ("force", "N") if rate.unit == "m/s" else ("torque", "N m")
    force = Signal(f"{name}_{kind}{ending}", unit)
    return Freedom(place, rate, force, Signal(f"{name}_acceleration{ending}", per_second(rate.unit)))


def _shift(name: str, ending: str = "") -> Freedom:
    place = f"{name}{ending}"
    return _freedom(Signal(place, "m"), Signal(f"{place}_rate", "m/s"), name, ending)


def _turn(name: str, axis: str) -> Freedom:
    """About one of the axes beyond."""
    place, rate = Signal(f"{name}_attitude_{axis}", "1"), Signal(f"{name}_rate_{axis}", "rad/s")
    return _freedom(place, rate, name, f"_{axis}")


def _angle(name: str, word: str = "") -> Freedom:
    place = f"{name}{word}"
    return _freedom(Signal(place, "rad"), Signal(f"{place}_rate", "rad/s"), name)


def freedoms(joint: Joint) -> tuple[Freedom, ...]:
    """The speeds of a joint, in order."""
    n = joint.name
    if joint.kind == "revolute":
        return (_angle(n),)
    if joint.kind == "prismatic":
        return (_shift(n),)
    if joint.kind == "planar":
        return (*(_shift(n, f"_{c}") for c in AXES[:2]), _angle(n, "_angle"))
    turns = tuple(_turn(n, c) for c in AXES)
    if joint.kind == "spherical":
        return turns
    return (*(_shift(n, f"_{c}") for c in AXES), *turns) if joint.kind == "free" else ()


def motor_of(joint: Joint) -> Freedom:
    """The speed of a motor behind an elastic gear."""
    return _angle(f"{joint.name}_motor")


def coordinates(joint: Joint) -> tuple[Signal, ...]:
    """The coordinates of a joint, in order."""
    own = tuple(f.place for f in freedoms(joint))
    if joint.kind not in TURNS:
        return own
    return (*own[: TURNS[joint.kind]], *(Signal(f"{joint.name}_quaternion_{k}", "1") for k in range(4)))


class Slot(NamedTuple):
    """Where a joint's coordinates and speeds begin among those of a tree."""

    joint: Joint
    q: int
    v: int

    @property
    def turn(self) -> tuple[int, int] | None:
        """Where its quaternion and its angular velocity begin."""
        at = TURNS.get(self.joint.kind)
        return None if at is None else (self.q + at, self.v + at)


def slots(joints: list[Joint]) -> tuple[Slot, ...]:
    """One joint's coordinates after the other's."""
    found, q, v = list[Slot](), 0, 0
    for joint in joints:
        found.append(Slot(joint, q, v))
        q, v = q + len(coordinates(joint)), v + len(freedoms(joint))
    return tuple(found)


def ends(found: tuple[Slot, ...]) -> tuple[int, int]:
    """(coordinates, speeds) of all of them."""
    if not found:
        return 0, 0
    last = found[-1]
    return last.q + len(coordinates(last.joint)), last.v + len(freedoms(last.joint))

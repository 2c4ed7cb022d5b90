"""What devices on a tree read: gyros and accelerometers at its places, force and torque on its base.

All of it follows from the motions at the accelerations that solve the equations; each place's own axes, the base's for
the reaction. The reaction is what the tree does to what holds it, its weight included; the spin of rotors is not in it.
The orientation of a place is a unit quaternion, scalar first, from its axes to the base's: a product of those of the
joints, so that it has no singular turns and, along a motion, no jump of sign, which three angles and a quaternion from
a matrix have. q and -q are the same.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import casadi as ca

from pliant.plants.core.signals import Sensed, Signal
from pliant.plants.multibody_parts.spatial import Wrench
from pliant.plants.multibody_recursion.kinematics import quaternions
from pliant.plants.multibody_recursion.newton_euler import motions, reaction
from pliant.plants.multibody_recursion.walk import Walk

AXES = ("x", "y", "z")
DEVICES = {"orientation": "1", "gyro": "rad/s", "accelerometer": "m/s^2", "reaction": "N"}


def signals(devices: Collection[str], places: Sequence[str]) -> list[Signal]:
    """Of the devices, by kind and place."""
    at_places = [d for d in ("gyro", "accelerometer") if d in devices]
    found = [Signal(f"{p}_quaternion_{k}", "1") for p in places for k in range(4)] if "orientation" in devices else []
    found += [Signal(f"{place}_{d}_{axis}", DEVICES[d]) for d in at_places for place in places for axis in AXES]
    if "reaction" in devices:
        found += [Signal(f"base_{word}_{a}", unit) for word, unit in (("force", "N"), ("torque", "N m")) for a in AXES]
    return found


def sensed(devices: Collection[str], places: Sequence[str]) -> list[Sensed]:
    """The gyros and accelerometers among them, as data sheets have them."""
    carried = [d for d in devices if d in ("gyro", "accelerometer")]
    return [Sensed(d, f"{place}_{d}_{axis}") for d in carried for place in places for axis in AXES]


def readings(
    walk: Walk, a: ca.SX, gravity: ca.SX, external: dict[int, Wrench], devices: Collection[str], places: Sequence[int]
) -> list[ca.SX]:
    """In the order of `signals`, at accelerations `a` of the walk's coordinates."""
    moves = motions(walk, gravity, a)
    found = list[ca.SX]()
    if "orientation" in devices:
        turned = quaternions(walk)
        found += [turned[k] for k in places]
    if "gyro" in devices:
        found += [moves[k].omega for k in places]
    if "accelerometer" in devices:
        found += [moves[k].a for k in places]
    if "reaction" in devices:
        found += [*reaction(walk, moves, a, external)]
    return found

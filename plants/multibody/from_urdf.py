"""The bodies of a tree from a machine's URDF: beams in the place of links that bend, motors in that of stiff joints."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import require_instance, require_mapping, shown
from pliant.plants.multibody_parts.joint import DRIVES, SINGLE, ElasticJoint, Joint
from pliant.plants.multibody_parts.tree_body import TreeBody
from pliant.plants.multibody_parts.urdf import ZERO, Link, Machine, Numbers, UrdfJoint
from pliant.plants.multibody_recursion.layout import turned

TOLERANCE = 1e-3  # of a beam's length against the distance of its joints
MODES = (2, 2, 1, 0)


def bodies(machine: Machine, flexible: Any, joints: Any, modes: Any, drives: Any, tip: str) -> tuple[TreeBody, ...]:
    """In the order of the machine's joints."""
    moved = [j.name for j in machine.joints if j.kind != "fixed"]
    below = [j.child for j in machine.joints]
    beams = _by_name("from_urdf.flexible", flexible, below, "link", Beam)
    gears = _by_name("from_urdf.joints", joints, moved, "joint that moves", ElasticJoint)
    shapes = require_mapping("from_urdf.modes", modes, tuple(beams), "flexible link") if modes is not None else {}
    driven = require_mapping("from_urdf.drives", drives, moved, "joint that moves") if drives is not None else {}
    for name, drive in driven.items():
        if drive not in DRIVES:
            raise ValueError(f"from_urdf.drives[{name!r}] = {shown(drive)} must be one of {', '.join(DRIVES)}")
    if tip and tip not in machine.links:
        raise ValueError(f"from_urdf.tip = {shown(tip)} must be a link: {', '.join(machine.links)}")
    _check_weight(machine, beams)
    lines = {name: Line.of(machine, name, beam) for name, beam in beams.items()}
    found = []
    for joint in machine.joints:
        hung = _hung(joint, lines.get(joint.parent), gears.get(joint.name), driven.get(joint.name, ""))
        parent, name, beam = joint.parent, joint.child, beams.get(joint.child)
        if beam is None:
            found.append(TreeBody(name=name, joint=hung, parent=parent, **_inertia(machine.links[name])))
            continue
        options: dict[str, Any] = {"modes": shapes.get(name, MODES), "beam_rotation": lines[name].rotation}
        found.append(TreeBody(name=name, joint=hung, parent=parent, beam=beam, **options))
    return tuple(found)


def platform(machine: Machine, base: Any) -> dict[str, Any]:
    """The root link as a base that moves."""
    if base not in ("free", "driven"):
        return {}
    found = _inertia(machine.links[machine.root])
    return {"platform": Payload(found["mass"], found["inertia"], found["centre"])}


def tell_repairs(path: Any, repairs: tuple[str, ...]) -> None:
    """Warn of what was changed in a file's inertias."""
    if repairs:
        warnings.warn(f"{path} has inertias that no body has: {'; '.join(repairs)}", UserWarning, stacklevel=3)


def _by_name(name: str, value: Any, known: list[str], kind: str, of: type) -> dict[str, Any]:
    found = require_mapping(name, value, tuple(known), kind) if value is not None else {}
    for key, one in found.items():
        require_instance(f"{name}[{key!r}]", one, of)
    return found


def _check_weight(machine: Machine, beams: Mapping[str, Beam]) -> None:
    """ValueError where a joint moves nothing that has mass."""
    heavy = {name for name, link in machine.links.items() if link.mass > 0 or name in beams}
    for joint in reversed(machine.joints):
        if joint.child in heavy:
            heavy.add(joint.parent)
        elif joint.kind != "fixed":
            raise ValueError(
                f"joint {joint.name!r} moves link {joint.child!r} of mass = {machine.links[joint.child].mass!r} and "
                "nothing heavier beyond it, must move a mass > 0 [kg]"
            )


def _inertia(link: Link) -> dict[str, Any]:
    R = turned(link.rotation)
    tensor = R @ np.array(link.inertia) @ R.T if any(link.rotation) else np.array(link.inertia)
    inertia = tuple(tuple(float(e) for e in row) for row in (tensor + tensor.T) / 2)
    return {"mass": link.mass, "centre": link.centre, "inertia": inertia}


class Line:
    """Where a beam lies in its link: from the link's origin to its farthest joint (or the tip that hangs fixed there);
    without one, towards its mass centre.
    """

    def __init__(self, length: float, direction: np.ndarray) -> None:
        self.length, self.direction = length, direction
        self.rotation = shortest(direction)

    @classmethod
    def of(cls, machine: Machine, name: str, beam: Beam) -> Line:
        ends = {j.name: np.array(j.position) for j in machine.joints if j.parent == name}
        length = float(beam.length)
        if not ends:
            centre = np.array(machine.links[name].centre)
            far = float(np.linalg.norm(centre))
            return cls(length, centre / far if far else np.array([1.0, 0.0, 0.0]))
        last = max(ends, key=lambda joint: float(np.linalg.norm(ends[joint])))
        far = float(np.linalg.norm(ends[last]))
        if not abs(far - length) <= TOLERANCE * length:
            raise ValueError(
                f"from_urdf.flexible[{name!r}].length = {length!r} must be the distance of its joints, {far:.9g} [m], "
                f"to joint {last!r}"
            )
        return cls(length, ends[last] / far)

    def station(self, position: Numbers) -> tuple[float, Numbers]:
        """(x/L of the section nearest to a point of the link, the point from there)."""
        at = np.array(position)
        xi = min(max(float(at @ self.direction) / self.length, 0.0), 1.0)
        xi = 1.0 if abs(xi - 1) < TOLERANCE else xi
        rest = at - xi * self.length * self.direction
        rest = np.where(np.abs(rest) > 1e-12 * self.length, rest, 0.0)
        return xi, tuple(float(r) for r in rest)


def shortest(direction: np.ndarray) -> Numbers:
    """Roll, pitch, yaw that turn x into a direction: yaw and pitch alone."""
    x, y, z = (float(d) for d in direction)
    return 0.0, math.atan2(-z, math.hypot(x, y)), math.atan2(y, x) if math.hypot(x, y) > 1e-12 else 0.0


def _hung(joint: UrdfJoint, line: Line | None, gear: ElasticJoint | None, drive: str) -> Joint:
    position, station = joint.position, 1.0
    if line is not None:
        station, position = line.station(joint.position)
    x, y, z = joint.axis
    losses: dict[str, Any] = {}
    if joint.kind != "fixed":
        own = "torque" if joint.kind in SINGLE else "none"
        losses = {"damping": joint.damping, "friction": joint.friction, "drive": drive or own}
    return Joint(
        name=joint.name, kind=joint.kind, axis=(x, y, z), position=position or ZERO, rotation=joint.rotation,
        station=station, elastic=gear, lower=joint.lower, upper=joint.upper, effort=joint.effort, speed=joint.speed,
        **losses,
    )  # fmt: skip

"""A URDF file as links and joints: read, checked, put in order.

Every refusal names the element and the value. What tells looks and contact (visual, collision, transmission, gazebo) is
left alone; mimicking joints are refused. Joints of type "spherical" or "ball", which the format does not have, are
taken as other programs write them.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path

from pliant.plants.core.argument_gates import require_choice, require_path, shown

from . import urdf_inertia

Numbers = tuple[float, ...]
KINDS = {
    "revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic", "fixed": "fixed", "planar": "planar",
    "floating": "free", "spherical": "spherical", "ball": "spherical",
}  # fmt: skip
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
ZERO: Numbers = (0.0, 0.0, 0.0)
LARGEST_FILE = 50_000_000  # bytes


@dataclass(frozen=True)
class Link:
    """A link's inertia, about its mass centre in the link's own axes after `rotation` (roll, pitch, yaw)."""

    name: str
    mass: float = 0.0
    centre: Numbers = ZERO
    rotation: Numbers = ZERO
    inertia: tuple[Numbers, ...] = (ZERO, ZERO, ZERO)


@dataclass(frozen=True)
class UrdfJoint:
    """A joint between two links."""

    name: str
    kind: str
    parent: str
    child: str
    position: Numbers
    rotation: Numbers
    axis: Numbers
    damping: float
    friction: float
    lower: float | None
    upper: float | None
    effort: float | None
    speed: float | None


@dataclass(frozen=True)
class Machine:
    """Links by name, joints with parents before children else in the file's order, and the link that stands still."""

    links: dict[str, Link]
    joints: tuple[UrdfJoint, ...]
    root: str
    repairs: tuple[str, ...] = ()  # what was changed of inertias that no body has


def numbers(what: str, text: str | None, count: int, unit: str) -> Numbers:
    """`count` finite numbers of an attribute."""
    try:
        found = tuple(float(word) for word in (text or "").split())
    except ValueError:
        found = ()
    if len(found) != count or not all(map(math.isfinite, found)):
        many = "one finite number" if count == 1 else f"{count} finite numbers"
        raise ValueError(f"{what} = {shown(text)} must be {many} [{unit}]")
    return found


def _one(element: ET.Element, what: str, tag: str) -> ET.Element | None:
    """The only child of that tag."""
    found = element.findall(tag)
    if len(found) > 1:
        raise ValueError(f"{what} has {len(found)} elements <{tag}>, must have one")
    return found[0] if found else None


def _name(element: ET.Element, what: str, attribute: str = "name") -> str:
    found = element.get(attribute, "").strip()
    if not found:
        raise ValueError(f"{what}: {attribute} = {shown(element.get(attribute))} must be a name")
    return found


def _origin(element: ET.Element, what: str) -> tuple[Numbers, Numbers]:
    origin = _one(element, what, "origin")
    if origin is None:
        return ZERO, ZERO
    xyz, rpy = origin.get("xyz", "0 0 0"), origin.get("rpy", "0 0 0")
    return numbers(f"{what} origin xyz", xyz, 3, "m"), numbers(f"{what} origin rpy", rpy, 3, "rad")


def _link(element: ET.Element, inertias: str, repairs: list[str]) -> Link:
    name = _name(element, "<link>")
    what = f"link {name!r} inertial"
    inertial = _one(element, f"link {name!r}", "inertial")
    if inertial is None:
        return Link(name)
    mass, tensor = _one(inertial, what, "mass"), _one(inertial, what, "inertia")
    if mass is None or tensor is None:
        raise ValueError(f"{what} has no <{'mass' if mass is None else 'inertia'}>, must have one")
    (m,) = numbers(f"link {name!r} mass value", mass.get("value"), 1, "kg")
    if m < 0:
        raise ValueError(f"link {name!r} mass value = {m!r} must be >= 0 [kg]")
    xx, xy, xz, yy, yz, zz = (
        numbers(f"link {name!r} inertia {word}", tensor.get(word), 1, "kg m^2")[0] for word in MOMENTS
    )
    inertia = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    taken = urdf_inertia.of_link(name, m, inertia, inertias)
    repairs += [taken.change] if taken.change else []
    return Link(name, m, *_origin(inertial, what), taken.inertia)


def _limit(limit: ET.Element | None, what: str, word: str, unit: str) -> float | None:
    return None if limit is None or word not in limit.attrib else numbers(f"{what} {word}", limit.get(word), 1, unit)[0]


def _joint(element: ET.Element, mimic: str) -> UrdfJoint:
    name = _name(element, "<joint>")
    what, kind = f"joint {name!r}", element.get("type")
    if kind not in KINDS:
        raise ValueError(f"{what} type = {shown(kind)} must be one of {', '.join(KINDS)}")
    follows = _one(element, what, "mimic")
    if follows is not None and mimic != "free":
        raise ValueError(
            f"{what} mimics joint {follows.get('joint')!r}: a tree has no joint that follows; mimic='free' lets it "
            "move by itself"
        )
    ends = []
    for tag in ("parent", "child"):
        end = _one(element, what, tag)
        if end is None:
            raise ValueError(f"{what} has no <{tag}>, must have one")
        ends.append(_name(end, f"{what} {tag}", "link"))
    axis, dynamics, limit = (_one(element, what, tag) for tag in ("axis", "dynamics", "limit"))
    along = numbers(f"{what} axis xyz", axis.get("xyz"), 3, "1") if axis is not None else (1.0, 0.0, 0.0)
    length = math.hypot(*along)
    if kind in ("fixed", "floating", "spherical", "ball"):
        along, length = (0.0, 0.0, 1.0), 1.0  # means nothing there
    elif not length > 1e-9:
        raise ValueError(f"{what} axis xyz = {along} must have a length > 0")
    lost = {}
    for word in ("damping", "friction"):
        text = dynamics.get(word, "0") if dynamics is not None else "0"
        (lost[word],) = numbers(f"{what} dynamics {word}", text, 1, "SI")
        if lost[word] < 0:
            raise ValueError(f"{what} dynamics {word} = {lost[word]!r} must be >= 0")
        if lost[word] and kind in ("planar", "floating"):
            raise ValueError(
                f"{what} dynamics {word} = {lost[word]!r} must be 0 where type = {kind!r}: the format does not say of "
                "what"
            )
    bounded = limit if kind in ("revolute", "prismatic") else None
    lower, upper = (_limit(bounded, f"{what} limit", word, "rad or m") for word in ("lower", "upper"))
    if lower is not None and upper is not None and lower > upper:
        raise ValueError(f"{what} limit lower = {lower!r} must be at most upper = {upper!r}")
    effort, speed = (_limit(limit, f"{what} limit", word, "SI") for word in ("effort", "velocity"))
    for word, value in (("effort", effort), ("velocity", speed)):
        if value is not None and value < 0:
            raise ValueError(f"{what} limit {word} = {value!r} must be >= 0")
    unit = tuple(0.0 if abs(a / length) < 1e-15 else a / length for a in along)
    position, rotation = _origin(element, what)
    return UrdfJoint(
        name=name, kind=KINDS[kind], parent=ends[0], child=ends[1], position=position, rotation=rotation, axis=unit,
        damping=lost["damping"], friction=lost["friction"], lower=lower, upper=upper, effort=effort, speed=speed,
    )  # fmt: skip


def read(path: str | Path, mimic: str = "refused", inertias: str = "refuse") -> Machine:
    """The machine of a file; ValueError that names the element and the value where it is none. `mimic`: joints that
    mimic another are "refused" or "free". `inertias` that no body has: "refuse" or "repair".
    """
    require_choice("from_urdf", "mimic", mimic, ("refused", "free"))
    require_choice("from_urdf", "inertias", inertias, urdf_inertia.HOW)
    file = require_path("from_urdf.path", path)
    try:
        text = Path(file).read_bytes()
    except OSError as error:
        raise ValueError(f"from_urdf.path = {shown(str(file))} must be a file that can be read: {error}") from error
    if len(text) > LARGEST_FILE:
        raise ValueError(f"from_urdf.path = {shown(str(file))} has {len(text)} bytes, must have at most {LARGEST_FILE}")
    if b"<!ENTITY" in text:
        raise ValueError(f"from_urdf.path = {shown(str(file))} declares entities, must have none")
    try:
        robot = ET.fromstring(text)
    except ET.ParseError as error:
        raise ValueError(f"from_urdf.path = {shown(str(file))} must be XML: {error}") from error
    if robot.tag != "robot":
        raise ValueError(f"from_urdf.path = {shown(str(file))}: its root is <{robot.tag}>, must be <robot>")
    repairs = list[str]()
    links = [_link(e, inertias, repairs) for e in robot.findall("link")]
    joints = [_joint(e, mimic) for e in robot.findall("joint")]
    if not links:
        raise ValueError(f"from_urdf.path = {shown(str(file))} has no <link>, must have one at least")
    for kind, names in (("link", [k.name for k in links]), ("joint", [j.name for j in joints])):
        twice = next((n for k, n in enumerate(names) if n in names[:k]), None)
        if twice is not None:
            raise ValueError(f"{kind} {twice!r} stands there twice, must have a name of its own")
    machine = _ordered({k.name: k for k in links}, joints)
    for joint in machine.joints:
        link = machine.links[joint.child]
        if joint.kind != "fixed":
            taken = urdf_inertia.moved(link.name, joint.name, link.mass, link.inertia, inertias)
            machine.links[link.name] = replace(link, inertia=taken.inertia)
            repairs += [taken.change] if taken.change else []
    return replace(machine, repairs=tuple(repairs))


def _ordered(links: dict[str, Link], joints: list[UrdfJoint]) -> Machine:
    """One root, one joint to each other link, no loop."""
    above: dict[str, str] = {}
    for joint in joints:
        for end, word in ((joint.parent, "parent"), (joint.child, "child")):
            if end not in links:
                raise ValueError(f"joint {joint.name!r} {word} link = {end!r} must be one of {', '.join(links)}")
        if joint.child in above:
            raise ValueError(
                f"link {joint.child!r} is the child of joints {above[joint.child]!r} and {joint.name!r}, must be of "
                "one: a closed loop is no tree"
            )
        above[joint.child] = joint.name
    roots = [name for name in links if name not in above]
    if not roots:
        raise ValueError(f"joints {', '.join(j.name for j in joints)} close a loop: no link is without a parent")
    if len(roots) > 1:
        raise ValueError(
            f"links {', '.join(map(repr, roots))} have no joint above them, must be one link alone: the base"
        )
    placed, found, left = {roots[0]}, list[UrdfJoint](), list(joints)
    while left:
        nearest = next((j for j in left if j.parent in placed), None)
        if nearest is None:
            names = ", ".join(repr(j.name) for j in left)
            raise ValueError(f"joints {names} close a loop that does not hang on the base {roots[0]!r}")
        left.remove(nearest)
        found.append(nearest)
        placed.add(nearest.child)
    return Machine(links, tuple(found), roots[0])

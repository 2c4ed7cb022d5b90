"""Joints of a tree, what drives them, and named places on its bodies.

A joint hangs a body on another one: from the parent's own frame where that is rigid, from a section of its beam where
it is flexible, at `position`, in axes turned by `rotation` (roll, pitch, yaw about the fixed x, y, z, in that order, as
in a URDF). The joint turns about `axis`, or slides along it, both in those axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from pliant.plants.core.argument_gates import require_number, require_text, shown, unit_vector
from pliant.plants.core.parameters import flag, is_symbolic, quantity, require_choice, validate

KINDS = ("revolute", "prismatic", "fixed", "spherical", "planar", "free")
SINGLE = ("revolute", "prismatic")  # of one coordinate
DRIVES = ("torque", "acceleration", "none")
AS_BUILT = "decides which terms the equations have"


def name_gate(name: str, value: Any) -> str:
    """A name of a part."""
    return require_text(name, value)


def place_gate(name: str, value: Any) -> str:
    """A name of a part, or "" for what stands there by itself."""
    return require_text(name, value, empty=True)


def limit_gate(name: str, value: Any) -> float | None:
    """A number, or None where there is no limit."""
    return None if value is None else require_number(name, value)


@dataclass(frozen=True, kw_only=True)
class ElasticJoint:
    """A motor behind an elastic gear: the rotor's angle theta turns the joint by theta/ratio, less the twist.

    The spring's torque on the joint is stiffness (theta/ratio - q) + damping (theta'/ratio - q'). The rotor's energy is
    that of its own spin alone, J theta'^2/2: of a large ratio the rest is small (Spong, "Modeling and control of
    elastic joint robots", 1987). The input is the motor's torque at its own shaft.

    >>> ElasticJoint(stiffness=1e4, damping=2.0, ratio=100.0, rotor_inertia=2e-5).ratio
    100.0
    """

    stiffness: Any = quantity("N m/rad", "positive", uncertain=True)
    damping: Any = quantity("N m s/rad", "nonnegative", 0.0, uncertain=True)
    ratio: Any = quantity("1", "positive", 1.0)
    rotor_inertia: Any = quantity("kg m^2", "positive")
    rotor_friction: Any = quantity("N m s/rad", "nonnegative", 0.0)

    def __post_init__(self) -> None:
        validate(self)


def _elastic_gate(name: str, value: Any) -> Any:
    if value is not None and not isinstance(value, ElasticJoint):
        raise ValueError(f"{name} = {shown(value)} must be an ElasticJoint or None")
    return value


@dataclass(frozen=True, kw_only=True)
class Sliding:
    """What holds the shifts of a "planar" or "free" joint: a spring to zero, damping, dry friction, and stops where
    each of them reaches `lower` and `upper`; as those of `Joint`, in metres.

    >>> Sliding(stiffness=200.0, damping=3.0).stiffness
    200.0
    """

    stiffness: Any = quantity("N/m", "nonnegative", 0.0)
    damping: Any = quantity("N s/m", "nonnegative", 0.0, uncertain=True)
    friction: Any = quantity("N", "nonnegative", 0.0, uncertain=True)
    friction_rate: Any = quantity("m/s", "positive", 0.01)
    stop_stiffness: Any = quantity("N/m", "nonnegative", 0.0)
    stop_width: Any = quantity("m", "positive", 0.01)
    lower: float | None = field(default=None, metadata={"gate": limit_gate})
    upper: float | None = field(default=None, metadata={"gate": limit_gate})

    def __post_init__(self) -> None:
        validate(self)
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise ValueError(f"Sliding.lower = {self.lower!r} must be at most upper = {self.upper!r}")


def _sliding_gate(name: str, value: Any) -> Any:
    if value is not None and not isinstance(value, Sliding):
        raise ValueError(f"{name} = {shown(value)} must be a Sliding or None")
    return value


@dataclass(frozen=True, kw_only=True)
class Joint:
    """How a body hangs on its parent; its coordinate is an angle [rad], or a length [m] where it is "prismatic".

    "planar" slides along two axes across `axis` and turns about it; "spherical" turns as it likes, by a quaternion;
    "free" does so and moves along x, y, z of the axes before (see `freedoms`). Of these, stiffness, damping, friction
    and stops are the turn's (see `joint_forces`), those of the shifts are `sliding`.

    `station` is the section x/L of a flexible parent's beam that it hangs from, `node` the named node of a parent given
    by its modes; `turned`: whether it turns with that section or node. Of a prismatic joint N m reads N, and rad m.
    `friction` is dry, friction rate/sqrt(rate^2 + friction_rate^2). `armature` is the inertia of a stiff gear's rotor,
    felt at the joint. `drive`: the input is a "torque", an "acceleration" (the motion is then given, its torque a
    reaction), or there is "none". Limits are told, and held where `stop_stiffness` > 0: by the spring k d^2/2 with
    d = (z + sqrt(z^2 + stop_width^2))/2, z beyond them.

    >>> Joint(name="shoulder", axis=(0, 0, 1), damping=0.1).kind
    'revolute'
    """

    name: str = field(metadata={"gate": name_gate})
    kind: str = "revolute"
    axis: tuple[float, float, float] = field(default=(0.0, 0.0, 1.0), metadata={"gate": unit_vector})
    position: Any = quantity("m", "finite", (0.0, 0.0, 0.0), shape=(3,))
    rotation: Any = quantity("rad", "finite", (0.0, 0.0, 0.0), shape=(3,), fixed=AS_BUILT)
    station: Any = quantity("1", "nonnegative", 1.0, fixed=AS_BUILT)
    node: str = field(default="", metadata={"gate": place_gate})
    turned: bool = flag(True)
    damping: Any = quantity("N m s/rad", "nonnegative", 0.0, uncertain=True)
    friction: Any = quantity("N m", "nonnegative", 0.0, uncertain=True)
    friction_rate: Any = quantity("rad/s", "positive", 0.01)
    stiffness: Any = quantity("N m/rad", "nonnegative", 0.0)
    rest: Any = quantity("rad", "finite", 0.0)
    stop_stiffness: Any = quantity("N m/rad", "nonnegative", 0.0)
    stop_width: Any = quantity("rad", "positive", 0.01)
    armature: Any = quantity("kg m^2", "nonnegative", 0.0)
    drive: str = "torque"
    elastic: ElasticJoint | None = field(default=None, metadata={"gate": _elastic_gate})
    lower: float | None = field(default=None, metadata={"gate": limit_gate})
    upper: float | None = field(default=None, metadata={"gate": limit_gate})
    effort: float | None = field(default=None, metadata={"gate": limit_gate})
    speed: float | None = field(default=None, metadata={"gate": limit_gate})
    sliding: Sliding | None = field(default=None, metadata={"gate": _sliding_gate})

    def __post_init__(self) -> None:
        validate(self)
        require_choice("Joint", "kind", self.kind, KINDS)
        require_choice("Joint", "drive", self.drive, DRIVES)
        if self.station > 1:
            raise ValueError(f"Joint.station = {self.station!r} of joint {self.name!r} must be within [0, 1]")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise ValueError(
                f"Joint.lower = {self.lower!r} of joint {self.name!r} must be at most upper = {self.upper!r}"
            )
        if self.elastic is not None and (self.kind not in SINGLE or self.drive != "torque"):
            raise ValueError(
                f"Joint.elastic of joint {self.name!r} must be None where kind = {self.kind!r}, drive = {self.drive!r}:"
                " a motor drives a joint that turns or slides, by its torque"
            )
        self._check_kind()

    def _check_kind(self) -> None:
        """What joints of several coordinates have and have not."""
        several = self.kind in ("spherical", "planar", "free")
        if self.sliding is not None and self.kind not in ("planar", "free"):
            raise ValueError(
                f"Joint.sliding of joint {self.name!r} must be None where kind = {self.kind!r}: only planar and free "
                "joints have shifts beside a turn"
            )
        if several and (is_symbolic(self.armature) or self.armature):
            raise ValueError(
                f"Joint.armature = {shown(self.armature)} of joint {self.name!r} must be 0 where kind = {self.kind!r}"
            )
        if self.kind not in ("spherical", "free"):
            return
        for word, value in (("rest", self.rest), ("lower", self.lower)):
            if is_symbolic(value) or value:
                raise ValueError(
                    f"Joint.{word} = {shown(value)} of joint {self.name!r} must be left out where kind = "
                    f"{self.kind!r}: its turn is measured from where its axes are parallel, up to `upper`"
                )
        if self.upper is not None and not 0 < self.upper < math.pi:
            raise ValueError(
                f"Joint.upper = {self.upper!r} of joint {self.name!r} must be within (0, pi) where kind = "
                f"{self.kind!r} [rad]"
            )

    @property
    def moves(self) -> bool:
        """Whether it has a coordinate."""
        return self.kind != "fixed"

    @property
    def slides(self) -> bool:
        """Whether its coordinate is a length."""
        return self.kind == "prismatic"


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A named place on a body, or on the base: a tool, a sensor. Placed as a joint is.

    >>> Frame(name="camera", body="hand", position=(0.0, 0.0, 0.1)).body
    'hand'
    """

    name: str = field(metadata={"gate": name_gate})
    body: str = field(metadata={"gate": name_gate})
    position: Any = quantity("m", "finite", (0.0, 0.0, 0.0), shape=(3,))
    rotation: Any = quantity("rad", "finite", (0.0, 0.0, 0.0), shape=(3,), fixed=AS_BUILT)
    station: Any = quantity("1", "nonnegative", 1.0, fixed=AS_BUILT)
    node: str = field(default="", metadata={"gate": place_gate})

    def __post_init__(self) -> None:
        validate(self)
        if self.station > 1:
            raise ValueError(f"Frame.station = {self.station!r} of frame {self.name!r} must be within [0, 1]")


@dataclass(frozen=True, kw_only=True)
class FrameThruster:
    """A thruster at a named frame of any body: it pushes along `direction`, in the frame's axes; its input is [N].

    >>> FrameThruster(frame="nozzle", direction=(0.0, 0.0, 1.0)).frame
    'nozzle'
    """

    frame: str = field(metadata={"gate": name_gate})
    direction: tuple[float, float, float] = field(metadata={"gate": unit_vector})

    def __post_init__(self) -> None:
        validate(self)

"""A body of a tree: a rigid part, a beam or a body given by its modes, or both."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from pliant.plants.beams.payload import check_inertia
from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import require_counts, require_number, shown
from pliant.plants.core.parameters import is_symbolic, part, quantity, require_count, validate
from pliant.plants.modal_data.modal_data import ModalData

from .joint import AS_BUILT, Joint, name_gate, place_gate

MOST_MODES = 12  # of one family: beyond, RK4's step falls as 1/n^4


def _beam_gate(name: str, value: Any) -> Any:
    if value is not None and not isinstance(value, Beam):
        raise ValueError(f"{name} = {shown(value)} must be a Beam or None")
    return value


def _modal_gate(name: str, value: Any) -> Any:
    if value is not None and not isinstance(value, ModalData):
        raise ValueError(f"{name} = {shown(value)} must be ModalData or None")
    return value


@dataclass(frozen=True, kw_only=True)
class TreeBody:
    """A body that `joint` hangs on `parent` (another body's name, that of the base, or "" for the body before it).

    The rigid part has `mass`, its mass centre at `centre` and `inertia` about that, one moment about all axes or 3 x 3,
    in the axes of the body's frame, which stands where the joint is. A `beam` starts there too, along x of axes turned
    by `beam_rotation` (roll, pitch, yaw): it bends in its x-y plane by `modes[0]` shapes and in x-z by `modes[1]`,
    twists by `modes[2]` and stretches by `modes[3]`, and what hangs on the body hangs on its sections. A section's
    turning inertia counts in torsion alone, but with exact rotations also as the straight beam bends.

    `modal` data stand in the place of a beam, in those turned axes, with the `modal_modes` slowest of their modes
    (None: all), their stiffness times `stiffness_factor`, and `damping_ratio` besides their own damping; what hangs on
    the body hangs on its named nodes.

    >>> from pliant.plants import Beam, beams
    >>> strip = Beam.rectangular(1.0, 0.05, 0.003, beams.ALUMINIUM)
    >>> TreeBody(name="forearm", joint=Joint(name="elbow"), beam=strip, modes=(2, 2, 1, 0)).modes
    (2, 2, 1, 0)
    """

    name: str = field(metadata={"gate": name_gate})
    joint: Joint = part(Joint)
    parent: str = field(default="", metadata={"gate": place_gate})
    mass: Any = quantity("kg", "nonnegative", 0.0, uncertain=True)
    centre: Any = quantity("m", "finite", (0.0, 0.0, 0.0), shape=(3,))
    inertia: Any = quantity("kg m^2", "finite", 0.0, or_shape=(3, 3))
    beam: Beam | None = field(default=None, metadata={"gate": _beam_gate})
    beam_rotation: Any = quantity("rad", "finite", (0.0, 0.0, 0.0), shape=(3,), fixed=AS_BUILT)
    modes: tuple[int, ...] = (2, 2, 1, 0)
    modal: ModalData | None = field(default=None, metadata={"gate": _modal_gate})
    modal_modes: int | None = None
    stiffness_factor: Any = quantity("1", "positive", 1.0, uncertain=True)
    damping_ratio: Any = quantity("1", "nonnegative", 0.0, uncertain=True)

    def __post_init__(self) -> None:
        validate(self)
        object.__setattr__(self, "modes", require_counts("TreeBody", "modes", self.modes, 0, MOST_MODES, length=4))
        check_inertia(f"TreeBody.inertia of body {self.name!r}", self.inertia)

        if self.modal is not None:
            if self.beam is not None:
                raise ValueError(f"TreeBody.modal of body {self.name!r} must be None where it has a beam")
            most = self.modal.n
            count = most if self.modal_modes is None else self.modal_modes
            object.__setattr__(self, "modal_modes", require_count("TreeBody", "modal_modes", count, 0, most))

    @classmethod
    def wheel(
        cls,
        name: str,
        parent: str,
        *,
        inertia: Any,
        axis: Any = (0.0, 0.0, 1.0),
        position: Any = (0.0, 0.0, 0.0),
        mass: Any = 0.0,
        friction: Any = 0.0,
    ) -> Self:
        """A reaction wheel: a thin disc of `inertia` J about `axis`, J/2 across it, [kg m^2], on any body, its centre
        at `position` (3,) [m] there.

        Its input `name`_torque is the motor's on the wheel [N m], the negative on the body; `friction` is the bearing's
        [N m s/rad]. What carries it does not count the wheel, unlike `Wheel` of a spacecraft's hub.

        >>> TreeBody.wheel("spinner", "hub", inertia=0.02, axis=(1.0, 0.0, 0.0)).name
        'spinner'
        """
        friction = require_number("TreeBody.wheel.friction", friction, "nonnegative", "N m s/rad")
        joint = Joint(name=name, axis=axis, position=position, damping=friction)
        J, a = require_number("TreeBody.wheel.inertia", inertia, "positive", "kg m^2"), np.array(joint.axis)
        tensor = J / 2 * (np.eye(3) + np.outer(a, a))
        rows = tuple(tuple(float(e) for e in row) for row in tensor)
        return cls(name=name, parent=parent, joint=joint, mass=mass, inertia=rows)

    @property
    def bends(self) -> bool:
        """Whether it has a beam or modal data."""
        return self.beam is not None or self.modal is not None

    @property
    def weightless(self) -> bool:
        """Whether it has neither mass nor inertia, as a body that only places another."""
        entries = [self.mass, *np.ravel(np.array(self.inertia, dtype=object))]
        return not self.bends and not any(is_symbolic(e) or e != 0.0 for e in entries)

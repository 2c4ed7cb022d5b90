"""What a tree says of its fidelities, and which sensors such a machine carries."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Self

from pliant.plants.core.signals import Sensed
from pliant.plants.dynamics.plant_contract import PINION
from pliant.plants.multibody_parts.tree_body import MOST_MODES

from .declaration import TreeDeclaration
from .measurements import sensed

PHYSICS = 4  # shapes of a family that physics has by itself
UNMODELLED = ("exact rotations of the beams", "shear and rotary inertia of the beams", "plasticity", "backlash")
RIGID = ("bending of the bodies", "backlash")


@dataclass(frozen=True, kw_only=True)
class TreeFidelity(TreeDeclaration):
    """Answers about the tree as a whole."""

    def sensors(self) -> tuple[Sensed, ...]:
        units = {s.name: s.unit for s in self.coordinates}
        found = [Sensed("encoder", j.position, scale=PINION if units[j.position] == "m" else 1.0) for j in self.joints]
        for b in self.slender:
            beam: Any = b.beam
            depths = ((3 * beam.I_z / beam.area) ** 0.5, (3 * beam.I_y / beam.area) ** 0.5)
            for axis, depth, n in zip("yz", depths, b.modes[:2], strict=True):
                if n:
                    found.append(Sensed("strain gauge", f"{b.name}_curvature_{axis}", scale=1 / depth))
        return (*found, *sensed(self.devices, self.places))

    @property
    def deflections(self) -> tuple[str, ...]:
        return tuple(f"{b.name}_deflection_{axis}" for b in self.slender for axis in "yz")

    @property
    def output_rates(self) -> dict[str, str]:
        known = {s.name for s in self.outputs}
        return {name: f"{name}_rate" for name in known if f"{name}_rate" in known}

    @property
    def label(self) -> str:
        if not self.flexible:
            return "rigid"
        modes = ", ".join("+".join(map(str, self.counts(b))) for b in self.flexible)
        return f"{self.kinematics}, {self.basis} {modes}"

    def _with(self, kinematics: str, most: int) -> Self:
        """With as many shapes of each family that a body has."""
        bodies = tuple(dataclasses.replace(b, modes=tuple(min(n, 1) * most for n in b.modes)) for b in self.bodies)
        return dataclasses.replace(self, bodies=bodies, kinematics=kinematics)

    def ladder(self) -> tuple[Self, ...]:
        """From rigid bodies through one to four shapes a family, with and without shortening."""
        if not any(b.beam is not None and sum(b.modes) for b in self.bodies):
            return (self,)
        rungs = (("linear", 1), ("linear", 2), ("stiffened", 1), ("stiffened", 2), ("stiffened", 3), ("stiffened", 4))
        return (dataclasses.replace(self, kinematics="rigid"), *(self._with(*rung) for rung in rungs))

    def physics(self, more: int = 0) -> Self:
        """Stiffened, every beam bending in both planes and twisting, with `more` than four shapes a family; stretching
        where it does already.
        """
        n = min(max(PHYSICS + more, 1), MOST_MODES)
        modes = {b.name: (n, n, n, min(b.modes[3], 1) * n) for b in self.slender}
        bodies = tuple(dataclasses.replace(b, modes=modes[b.name]) if b.name in modes else b for b in self.bodies)
        return dataclasses.replace(self, bodies=bodies, kinematics="stiffened")

    @property
    def effects(self) -> dict[str, bool]:
        bends = bool(self.flexible)
        return {"bending": bends, "shortening of the bent beams": bends and self.kinematics == "stiffened"}

    def _lacking(self, effect: str) -> Self:
        changes = {"bending": "rigid", "shortening of the bent beams": "linear"}
        return dataclasses.replace(self, kinematics=changes[effect])

    @property
    def unmodelled(self) -> tuple[str, ...]:
        stiff = () if all(b.modes[3] for b in self.slender) else ("stretch of the beams",)
        return (*UNMODELLED, *stiff) if self.slender else RIGID

"""What a tree says of its fidelities, and which sensors such a machine carries."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Self

import numpy as np

from pliant.plants.core.signals import Sensed
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant_contract import PINION
from pliant.plants.modal_data.driven_families import before_the_last, left_out
from pliant.plants.multibody_joints.freedoms import freedoms
from pliant.plants.multibody_parts.geared_inputs import GearedInputs
from pliant.plants.multibody_parts.tree_body import MOST_MODES, TreeBody
from pliant.plants.validity.rotating_sections import AXIAL, TURN, largest_reached, longer

from .declaration import TreeDeclaration
from .measurements import sensed
from .sparing import needed

Array = np.ndarray
PHYSICS = 4  # shapes of a family that physics has by itself
UNMODELLED = ("shear and rotary inertia of the beams", "plasticity", "backlash")
MODAL = ("exact rotations of the bodies given by modes", "modes that their modal data leave out")
RIGID = ("bending of the bodies", "backlash")
STRETCH, EXACT, SHORTENING = "stretch of the beams", "exact rotations of the beams", "shortening of the bent beams"
LADDER = (
    ("linear", 1),
    ("linear", 2),
    ("stiffened", 1),
    ("stiffened", 2),
    ("stiffened", 3),
    ("stiffened", 4),
    ("strain", 2),
    ("strain", 3),
    ("strain", 4),
)


@dataclass(frozen=True, kw_only=True)
class TreeFidelity(TreeDeclaration):
    """Answers about the tree as a whole."""

    def sensors(self) -> tuple[Sensed, ...]:
        moved = sum(len(freedoms(b.joint)) for b in self.ground)
        carried = [self.freedoms[v].place for _, v in self._inputs if v >= moved]
        found = [Sensed("encoder", p.name, scale=PINION if p.unit == "m" else 1.0) for p in carried]
        if self.base == "free":
            found += [Sensed("star tracker", f.place.name, "rad") for f in self.freedoms[3:6]]
            found += [Sensed("fibre-optic gyro", f.rate.name) for f in self.freedoms[3:6]]
        for b in self.slender:
            if b.beam is None:
                continue
            beam: Any = b.beam
            depths = ((3 * beam.I_z / beam.area) ** 0.5, (3 * beam.I_y / beam.area) ** 0.5)
            for axis, depth, n in zip("yz", depths, b.modes[:2], strict=True):
                if n:
                    found.append(Sensed("strain gauge", f"{b.name}_curvature_{axis}", scale=1 / depth))
        return (*found, *sensed(self.devices, self.places))

    @property
    def deflections(self) -> tuple[str, ...]:
        return tuple(f"{b.name}_deflection_{axis}" for b in self.slender for axis in ("yz" if b.beam else "xyz"))

    @property
    def output_rates(self) -> dict[str, str]:
        known = {s.name for s in self.outputs}
        return {name: f"{name}_rate" for name in known if f"{name}_rate" in known}

    @property
    def label(self) -> str:
        if not self.flexible:
            return "rigid, elastic joints" if self.motors else "rigid"
        modes = ", ".join("+".join(map(str, self.counts(b))) for b in self.flexible)
        return f"{self.kinematics}, {self.basis} {modes}"

    def _with(self, kinematics: str, most: int) -> Self:
        """With as many shapes of each family that a beam has, and of a body's modes."""
        shapes = [tuple(min(n, 1) * most for n in b.modes) if b.beam else b.modes for b in self.bodies]
        bodies = [dataclasses.replace(b, modes=n) for b, n in zip(self.bodies, shapes, strict=True)]
        fewer = [b if b.modal is None else dataclasses.replace(b, modal_modes=min(most, b.modal.n)) for b in bodies]
        return dataclasses.replace(self, bodies=tuple(fewer), kinematics=kinematics)

    @property
    def stiff_geared(self) -> Self:
        """The same machine with gears that do not give: each rotor's inertia and friction felt at its joint."""
        bodies = list(self.bodies)
        for k, body in enumerate(bodies):
            gear = body.joint.elastic
            if gear is not None:
                damping = body.joint.damping + gear.ratio**2 * gear.rotor_friction
                armature = body.joint.armature + gear.ratio**2 * gear.rotor_inertia
                joint = dataclasses.replace(body.joint, elastic=None, damping=damping, armature=armature)
                bodies[k] = dataclasses.replace(body, joint=joint)
        return dataclasses.replace(self, bodies=tuple(bodies))

    def rest_to_rest(
        self, begin: Array, end: Array, time: float, *, profile: str = "minimum-jerk"
    ) -> Callable[[float], Array]:
        """Every driven joint on a motion of the profile, the gears taken as stiff: what twists them is left out.

        begin, end (nx,); time [s].
        """
        if not self.motors:
            return super().rest_to_rest(begin, end, time, profile=profile)
        geared = zip(self.freedoms[-len(self.motors) :], (self.moving[i].elastic for i in self.motors), strict=True)
        ratios = {f.force.name: float(gear.ratio) for f, gear in geared if gear is not None}
        return GearedInputs(self, self.stiff_geared, ratios, begin, end, time, profile)

    def ladder(self) -> tuple[Self, ...]:
        """From rigid bodies through one to four shapes a family and modes, with and without shortening, to exact
        rotations of beams.
        """
        bent = any(b.beam is not None and sum(b.modes) for b in self.bodies)
        if not bent and not any(b.modal is not None and b.modal.n for b in self.bodies):
            return (self,)
        rungs = tuple(rung for rung in LADDER if bent or rung[0] != "strain")
        bending: Callable[..., tuple[Self, ...]] = _bending
        if self.nominal is not self:  # symbols have no equality
            bending = _bending.__wrapped__
        return (dataclasses.replace(self, kinematics="rigid"), *bending(self._with(*LADDER[0]), rungs))

    def physics(self, more: int = 0) -> Self:
        """Exact rotations, every beam bending in both planes and twisting, with `more` than four shapes a family it
        has here, with one of others, and with `more` two. It stretches where it does already. Of modal data all modes,
        without `more` but the last about each axis.
        """
        n = min(max(PHYSICS + more, 1), MOST_MODES)
        return dataclasses.replace(self, bodies=tuple(_rich(b, n, more) for b in self.bodies), kinematics=self._richest)

    @property
    def _richest(self) -> str:
        return "strain" if any(b.beam is not None for b in self.bodies) else "stiffened"

    @property
    def left_out(self) -> float:
        data = [b.modal for b in self.bodies if b.modal is not None]
        return max((left_out(one, turned=False) for one in data), default=super().left_out)

    def estimates(self, motion: Trajectory) -> dict[str, tuple[Self, ...]]:
        """Stretch: each beam without shapes of it `longer` for good."""
        if self.kinematics != "strain":
            return {}
        strains, turns = (iter(largest_reached(self, motion, what)) for what in (AXIAL, TURN))
        bodies, changed = list(self.bodies), False
        for k, body in enumerate(self.bodies):
            planes = sum(n > 0 for n in body.modes[:2]) if body.beam is not None else 0
            strain, turn = (max((next(each) for _ in range(planes)), default=0.0) for each in (strains, turns))
            if body.beam is not None and planes and not body.modes[3]:
                bodies[k], changed = dataclasses.replace(body, beam=longer(body.beam, strain, turn)), True
        return {STRETCH: (dataclasses.replace(self, bodies=tuple(bodies)),)} if changed else {}

    def sparing(self, motion: Trajectory, compared: tuple[str, ...], within: float) -> tuple[Self, ...]:
        """With the shapes of each plane, of torsion and of stretch that the motion needs, linear to exact rotations."""
        if not any(b.beam is not None for b in self.flexible):
            return ()
        found: Any = needed(self, motion, compared, within)
        if not found.flexible:
            return ()
        return tuple(dataclasses.replace(found, kinematics=name) for name in ("linear", "stiffened", "strain"))

    @property
    def effects(self) -> dict[str, bool]:
        bends = bool(self.flexible)
        found = {"bending": bends, SHORTENING: bends and self.kinematics in ("stiffened", "strain")}
        return found | ({EXACT: bends and self.kinematics == "strain"} if self._richest == "strain" else {})

    def _lacking(self, effect: str) -> Self:
        changes = {"bending": "rigid", SHORTENING: "linear", EXACT: "stiffened"}
        return dataclasses.replace(self, kinematics=changes[effect])

    @property
    def unmodelled(self) -> tuple[str, ...]:
        beams = [b for b in self.slender if b.beam is not None]
        stiff = () if all(b.modes[3] for b in beams) else (STRETCH,)
        modal = MODAL if len(beams) < len(self.slender) else ()
        return (*UNMODELLED, *stiff, *modal) if self.slender else RIGID


@lru_cache(maxsize=32)  # each of them has the same ones above it, and is asked for them
def _bending(first: TreeFidelity, rungs: tuple[tuple[str, int], ...]) -> tuple[Any, ...]:
    """A ladder's rungs that bend."""
    return tuple(first._with(*rung) for rung in rungs)


def _rich(body: TreeBody, n: int, more: int) -> TreeBody:
    """With n shapes of each family that its beam has, few of those that it has not, or with its modes.

    What a beam is not taken to do is little, and its first shape the most of it; its second tells with one shape more.
    """
    if body.modal is not None:
        return dataclasses.replace(body, modal_modes=body.modal.n if more else before_the_last(body.modal))
    if body.beam is None:
        return body
    few = 1 + (more > 0)
    families = tuple(n if own else few for own in body.modes[:3])
    return dataclasses.replace(body, modes=(*families, min(body.modes[3], 1) * n))

"""Fields of a beam: which strains it has, how its root moves, what acts on its tip, how it is bent at rest."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from pliant.plants.core.argument_gates import require_by_name, require_names, shown
from pliant.plants.core.casadi_functions import NumericFunction, built_once, function
from pliant.plants.core.parameters import (
    flag,
    is_symbolic,
    quantity,
    require_choice,
    require_count,
)
from pliant.plants.core.signals import Signal, names
from pliant.plants.dynamics.declaration import Array
from pliant.plants.dynamics.lagrangian import LagrangianPlant

from . import load_path
from .rest_shape import is_curved, rest_curvature
from .strained_beam import StrainedBeam
from .tip_loads import LOADS, TipLoads

ROOTS = {  # root: its angle, where it turns
    "clamped": (),
    "hinged": ("root_angle",),
    "driven": ("hub_angle",),
    "free": ("root_angle",),
    "moving": ("root_angle",),
}
PRESCRIBED = ("driven", "moving")  # their accelerations are inputs
TRAVELLING = ("free", "moving")
THEORIES = ("euler-bernoulli", "timoshenko")
MOST_SEGMENTS = 32
MOST_STRAINS = 20  # stretches, shears


@dataclass(frozen=True, kw_only=True)
class StrainDeclaration(LagrangianPlant):
    """What a beam has beside bending and torsion; a beam that has none of it keeps to its rotations."""

    planar: bool = flag(True)
    kinematics: str = "strain"
    segments: int = 1  # sub-beams ("substructured"), or parts ("strain"), each with strains of its own
    root: str = "clamped"
    theory: str = "euler-bernoulli"  # "timoshenko": sections shear
    extensible: bool = flag(False)
    stretches: int = 2  # shapes of extension (extensible=True)
    shears: int = 2  # shapes of shear, in space along each axis of the section (theory="timoshenko")
    tip_loads: tuple[str, ...] = dataclasses.field(default=("force",), metadata={"gate": require_names})
    rest_curvature: Any = dataclasses.field(default=0.0, metadata={"gate": rest_curvature, "unit": "1/m"})  # about z
    rotary: Any = quantity("1", "nonnegative", 1.0)  # sections' rotary inertia over density times moment of area

    def _check_strains(self, owner: str) -> None:
        """ValueError for what cannot be, or not with its kinematics."""
        object.__setattr__(self, "segments", require_count(owner, "segments", self.segments, 1, MOST_SEGMENTS))
        require_choice(owner, "root", self.root, tuple(ROOTS))
        require_choice(owner, "theory", self.theory, THEORIES)
        names = require_names(f"{owner}.tip_loads", self.tip_loads, LOADS, "load")
        if not names and self.root not in PRESCRIBED:
            raise ValueError(f"{owner}.tip_loads = () must name at least one of {', '.join(LOADS)}")
        for name in ("stretches", "shears"):
            object.__setattr__(self, name, require_count(owner, name, getattr(self, name), 1, MOST_STRAINS))
        if self.root == "free" and not self.planar:
            others = ", ".join(repr(root) for root in ROOTS if root != "free")
            raise ValueError(
                f"{owner}.root = 'free' must be one of {others} where planar = False: in space roots turn about z alone"
            )
        if self.kinematics != "strain" and self.strained:
            changed = next(name for name in CHANGES if _differs(self, name))
            raise ValueError(
                f"{owner}.{changed} = {shown(getattr(self, changed))} must be {CHANGES[changed]} where "
                f"kinematics = {self.kinematics!r}: only kinematics = 'strain' has such strains, loads and roots"
            )

    @property
    def strained(self) -> bool:
        """Whether its coordinates are strains: it has more than rotations of a straight beam under a tip force."""
        parted = self.kinematics == "strain" and self.segments > 1
        varies = not {"rest_curvature", "rotary"}.isdisjoint(self.varied)
        return parted or varies or any(_differs(self, name) for name in CHANGES)

    @property
    def stiff(self) -> bool:
        """Waves along the axis and of shear run through a slender beam while it hardly bends."""
        return self.extensible or self.theory == "timoshenko"

    @property
    def loads(self) -> TipLoads:
        """What acts on the tip."""
        return TipLoads(self.tip_loads, self.planar)

    @property
    def turns(self) -> bool:
        """Whether the root has an angle."""
        return bool(ROOTS[self.root])

    @property
    def root_coordinates(self) -> tuple[Signal, ...]:
        """Where the root is, as far as it moves."""
        axes = ("xy" if self.planar else "xyz") if self.root in TRAVELLING else ""
        return (*(Signal(f"root_{axis}", "m") for axis in axes), *(Signal(name, "rad") for name in ROOTS[self.root]))

    @property
    def strain_counts(self) -> dict[str, int]:
        """Shapes of extension and, along each axis of a section, of shear: none where there is no such strain."""
        return {"stretches": self.stretches * self.extensible, "shears": self.shears * (self.theory == "timoshenko")}

    @property
    def strain_coordinates(self) -> tuple[Signal, ...]:
        """Stretches and shears, what there is of them."""
        counts, segments = self.strain_counts, self.segments
        found = numbered("stretch", counts["stretches"], segments)
        for stem in ("shear",) if self.planar else ("shear", "shear_z"):
            found += numbered(stem, counts["shears"], segments)
        return tuple(Signal(name, "1") for name in found)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        if self.root == "driven":
            return (Signal("hub_acceleration", "rad/s^2"),)
        if self.root == "moving":
            return tuple(Signal(f"{s.name}_acceleration", f"{s.unit}/s^2") for s in self.root_coordinates)
        return self.loads.signals

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        return self.loads.signals if self.root in PRESCRIBED else ()

    @property
    def driven(self) -> dict[int, int]:
        return {k: k for k in range(len(self.root_coordinates))} if self.root in PRESCRIBED else {}

    @property
    def small_states(self) -> tuple[str, ...]:
        """Lengths and strains of the axis."""
        return tuple(s.name for s in self.states if s.unit in ("m", "m/s", "1", "1/s"))

    @property
    def strain_label(self) -> str:
        """What it has beside bending, in words that follow the shapes."""
        return "".join(f", {name} {n}" for name, n in self.strain_counts.items() if n)

    @property
    @abstractmethod
    def strained_beam(self) -> StrainedBeam:
        """Where its coordinates are strains: energies and equations."""

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[Array, Array]:
        """As of every plant. A clamped beam of strains under given loads is followed from the unloaded beam, or from
        the guess, in steps of the load: EquilibriumError where that branch is lost, never a rest on another one.
        `fixed` and `named` hold coordinates and loads by name.
        The state (nx,) and the inputs (nu,).
        """
        if self.strained and self.root == "clamped":
            given = (("guess", guess), ("fixed", fixed), ("named", named))
            start, *held = (require_by_name(f"equilibrium.{k}", {} if v is None else v) for k, v in given)
            loads = {**held[0], **held[1]}
            if set(loads) <= set(names(self.inputs)):
                return load_path.rest(self, loads, start, p)
        return super().equilibrium(fixed, guess=guess, p=p, **named)

    @property
    def _written_out(self) -> bool:
        return True

    def balance(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, a: ca.SX) -> ca.SX:
        if not (self.strained and self.planar):
            return super().balance(t, x, u, w, a)
        n = len(self.coordinates)
        return self.strained_beam.balance(x[:n], x[n:], a, w if self.driven else u)

    @built_once
    def _statics(self) -> NumericFunction:
        """(elastic forces, weight and loads) on the coordinates at x and u."""
        return function("statics", list(self.symbols), list(self._static_forces))

    @built_once
    def _static_forces(self) -> tuple[ca.SX, ca.SX]:
        _, x, u, _, _ = self.symbols
        elastic, outer = ca.cse(list(self.symbolic.strained_beam.statics(x[: len(self.coordinates)], u)))
        return elastic, outer

    @built_once
    def _along(self) -> NumericFunction:
        """How both change along directions d (n,) of the coordinates: columns of their Jacobians, which of many shapes
        are large expressions.
        """
        q, d = self.symbols[1][: len(self.coordinates)], ca.SX.sym("d", len(self.coordinates))
        changes = [ca.jtimes(force, q, d) for force in self._static_forces]
        return function("along", [*self.symbols, d], ca.cse(changes))

    @built_once
    def _momentum(self) -> NumericFunction:
        """Of rates d (n,): columns of the mass matrix."""
        q, d = self.symbols[1][: len(self.coordinates)], ca.SX.sym("d", len(self.coordinates))
        T = self.symbolic.strained_beam.kinetic_energy(q, d)
        return function("momentum", [*self.symbols, d], ca.cse([ca.gradient(T, d)]))


CHANGES = {  # field: what a beam of rotations alone has
    "root": "'clamped', 'hinged' or 'driven'",
    "theory": "'euler-bernoulli'",
    "extensible": "False",
    "tip_loads": "('force',)",
    "rest_curvature": "0.0",
    "rotary": "1.0",
}


def numbered(stem: str, count: int, segments: int, parted: bool = False) -> list[str]:
    """stem1, stem2, .. of one beam; stem1_1, stem1_2, .. segment by segment of several, or of one that is `parted`."""
    if segments == 1 and not parted:
        return [f"{stem}{k + 1}" for k in range(count)]
    return [f"{stem}{i + 1}_{k + 1}" for i in range(segments) for k in range(count)]


def _differs(beam: StrainDeclaration, name: str) -> bool:
    value = getattr(beam, name)
    if name == "root":
        return value in TRAVELLING
    if name == "rest_curvature":
        return is_curved(value)
    if name == "rotary":
        return is_symbolic(value) or value != 1.0
    return bool(value != {"theory": THEORIES[0], "extensible": False, "tip_loads": ("force",)}[name])

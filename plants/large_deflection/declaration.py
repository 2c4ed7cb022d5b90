"""What a beam of large deflection is: its parameters, its signals and the fields that its coordinates turn."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

from pliant.plants.beam_strains.declaration import StrainDeclaration, numbered
from pliant.plants.beam_strains.rest_shape import RestShape
from pliant.plants.beam_strains.strain_fields import PanelBends, integrated, legendre
from pliant.plants.beam_strains.strained_beam import StrainedBeam, of_declaration
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core import parameters
from pliant.plants.core.parameters import is_symbolic, part, quantity, require_choice, require_count, validate
from pliant.plants.core.signals import Sensed, Signal
from pliant.plants.exact_rotations.quadrature import points

from . import tangent_field
from .fields import Fields, of_chain, of_rotations
from .resolution import FINEST, Resolved, check_given, enough
from .sub_beam_chain import FRAMES, Chain
from .torsion import TorsionShapes

KINEMATICS = ("strain", "substructured")
BASES = {"tip-force": 20, "modes": 30, "polynomial": 20}  # basis: most shapes
MOST_TWISTS = 12
TRUNCATED = 2e-3  # error of the rule for bending shapes, well below that of leaving the others out
EXACT = 1e-6


@dataclass(frozen=True, kw_only=True)
class LargeBeamDeclaration(StrainDeclaration):
    """A beam, its root and its payload; `LargeDeflectionBeam` adds their energies and equations.

    `basis`, of n = `modes` rotation shapes: "tip-force", curvatures that vanish at an end free to turn; "modes",
    natural modes with the payload; "polynomial", any curvatures; "auto". In the plane "auto" serves the beam's own
    input, a tip force F, best: "tip-force" (up to 20 shapes, beyond them "modes"); in space it is "modes", whose bend1
    and flap1 are the first natural modes.
    Relative error of the tip's displacement, clamped, without payload, F L^2/(E I) = 1 across: at rest against the
    elastica's elliptic integrals; while F grows within half the first period, and where it is there at once, undamped
    and with stiffness-proportional damping (0.35 % in the first mode), for 3 sqrt(rho A L^4/(E I)), against nine
    shapes; the highest frequency in sqrt(E I/(rho A L^4)), which an explicit step must follow:

        n   basis        at rest   growing   at once   damped    highest
        2   modes        3.7e-3    3.1e-3    4.5e-3    4.2e-3    22
            polynomial   3.1e-4    2.3e-2    4.5e-2    4.3e-2    35
            tip-force    6.3e-6    2.3e-3    2.1e-2    8.1e-3    23
        3   modes        1.1e-3    1.0e-3    1.4e-3    9.9e-4    62
            polynomial   2.6e-6    1.2e-3    9.8e-3    3.5e-3    118
            tip-force    7.8e-7    1.4e-4    9.1e-3    1.9e-3    65
        4   modes        4.9e-4    4.3e-4    6.5e-4    4.1e-4    121
            polynomial   5.5e-7    8.6e-5    5.9e-3    1.3e-3    282
            tip-force    1.3e-8    1.0e-5    3.2e-3    1.2e-4    132
        8   modes        6.3e-5    -         -         -         555
            polynomial   1.8e-14   -         -         -         2586
            tip-force    1.3e-15   -         -         -         820

    The price: n natural modes have n exact frequencies where n others have fewer, so that "modes" follow free, undamped
    oscillations and those of a force that is there at once better, with two to six shapes by a factor of two to seven;
    `textbook`, let go under gravity, takes them.
    """

    beam: Beam = part(Beam)
    gravity: tuple[float, float, float] = quantity("m/s^2", "finite", (0.0, -9.8, 0.0), shape=(3,))
    payload: Payload = part(Payload, default_factory=Payload)
    modes: int = 3  # shapes, of each segment
    frame: str = "mean-axis"  # of each sub-beam ("substructured")
    basis: str = "auto"  # of the rotations ("strain")
    twists: int = 1  # torsion shapes (planar=False)
    points: int | None = None  # quadrature points of each segment; None: as many as it takes

    def __post_init__(self) -> None:
        validate(self)
        owner = "LargeDeflectionBeam"
        for name, choices in (("kinematics", KINEMATICS), ("frame", FRAMES), ("basis", ("auto", *BASES))):
            require_choice(owner, name, getattr(self, name), choices)
        self._check_strains(owner)
        most = BASES["modes" if self.basis == "auto" else self.basis]
        ranges = {
            "modes": (1, most if self.kinematics == "strain" else 12),
            "twists": (0, MOST_TWISTS),
        }
        if self.points is not None:
            ranges["points"] = (2, FINEST)
        for name, (least, greatest) in ranges.items():
            object.__setattr__(self, name, require_count(owner, name, getattr(self, name), least, greatest))
        if self.strained and self.segments > 1:
            require_choice(owner, "basis of segments", self.basis, ("auto", "polynomial"))
        symbolic = any(is_symbolic(parameters.get(self, path)) for path in parameters.quantities(self))
        if self.points is not None and not symbolic:
            check_given(owner, self.points, *self._resolved)

    @property
    def rotation_basis(self) -> str:
        """The basis that is taken: that which `basis` names, or where it is "auto" that for the plane or for space;
        "modes" too where more shapes are asked for than there are for a tip force.
        """
        if self.basis != "auto":
            return self.basis
        if self.strained and ("moment" in self.tip_loads or not self.planar or self.segments > 1):
            return "polynomial"
        return "tip-force" if self.planar and self.modes <= BASES["tip-force"] else "modes"

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        kinds = (("bend", self.modes), ("flap", self.modes), ("twist", self.twists))
        bent = []
        for kind, count in kinds[: 1 if self.planar else 3]:
            bent += numbered(kind, count, self.segments, self.kinematics == "substructured")
        return (*self.root_coordinates, *(Signal(name, "rad") for name in bent), *self.strain_coordinates)

    @property
    def outputs(self) -> tuple[Signal, ...]:
        return (
            *self.root_coordinates,
            Signal("tip_x", "m"),
            Signal("tip_y", "m"),
            Signal("tip_u", "m"),
            Signal("tip_v", "m"),
            Signal("tip_u_rate", "m/s"),
            Signal("tip_v_rate", "m/s"),
            Signal("tip_angle", "rad"),
            Signal("tip_deflection", "m"),
            Signal("tip_deflection_rate", "m/s"),
            Signal("tip_angle_rate", "rad/s"),
            Signal("root_curvature", "1/m"),
            *((Signal("tip_z", "m"), Signal("tip_z_rate", "m/s"), Signal("tip_twist", "rad")) * (not self.planar)),
        )

    def sensors(self) -> tuple[Sensed, ...]:
        """An encoder of a root in a bearing, a strain gauge at one that carries a moment, a gyro at the tip."""
        turning = [Sensed("encoder", s.name) for s in self.root_coordinates if s.unit == "rad" and self.root != "free"]
        gauge = Sensed("strain gauge", "root_curvature", scale=1 / self.beam.half_depth)
        carries = self.root not in ("hinged", "free")
        return (*turning, *((gauge,) if carries else ()), Sensed("gyro", "tip_angle_rate"))

    @property
    def deflections(self) -> tuple[str, ...]:
        return ("tip_deflection",)

    @property
    def output_rates(self) -> dict[str, str]:
        moving = ("tip_u", "tip_v", "tip_angle", "tip_deflection", *(() if self.planar else ("tip_z",)))
        return {name: f"{name}_rate" for name in moving}

    @property
    def seen_from(self) -> str | None:
        return {"driven": "hub_angle", "moving": "root_angle"}.get(self.root)

    @property
    def label(self) -> str:
        space = "" if self.planar else f", spatial, twists {self.twists}"
        if self.kinematics == "strain":
            parts = f"{self.segments} x " * (self.segments > 1)
            return f"strain, {self.rotation_basis} {parts}{self.modes}{space}{self.strain_label}"
        return f"substructured, {self.segments} x {self.modes}, {self.frame}{space}"

    @cached_property
    def fields(self) -> Fields:
        """What the coordinates turn, shapes from the nominal parameters."""
        if self.kinematics == "substructured":
            twists = None if self.planar else self.twists
            return of_chain(self.beam, self.payload, self._chain, self.point_count, twists)
        own: LargeBeamDeclaration = self.nominal
        at = points(own.point_count)
        return of_rotations(self.beam, self.payload, *own._rotations, at, None if self.planar else own._torsion)

    @cached_property
    def strained_beam(self) -> StrainedBeam:
        """The field of strains that carries the equations, of nq coordinates."""
        own: LargeBeamDeclaration = self.nominal
        return of_declaration(self, points(own.point_count, own.segments))

    @property
    def shapes(self) -> tangent_field.Rotations | Chain:
        """What the bending coordinates turn."""
        return self.fields.shapes

    @property
    def _chain(self) -> Chain:
        return Chain(self.segments, self.modes, self.frame, self.root != "clamped")

    @cached_property
    def _rotations(self) -> tuple[Any, Any]:
        """Bending about z and about y; a payload's inertia differs between them."""
        if self.strained and self.segments > 1:
            return PanelBends(self.modes, self.segments, self.turns), PanelBends(self.modes, self.segments, False)
        mass, length, load = self.beam.mass, self.beam.length, self.payload
        root = {"free": "hinged", "moving": "driven"}.get(self.root, self.root)  # what it can take of moments
        bend = tangent_field.rotations(root, self.rotation_basis, self.modes, **load.ratios(mass, length))
        return bend, tangent_field.rotations(
            "clamped", self.rotation_basis, self.modes, **load.ratios(mass, length, axis=1)
        )

    @cached_property
    def _torsion(self) -> TorsionShapes:
        own = self.beam.density * self.beam.polar_moment * self.beam.length
        return TorsionShapes(self.twists, self.payload.about_tip(0) / own)

    @property
    def _resolved(self) -> tuple[list[Resolved], int]:
        """What the quadrature points must resolve, and the fewest by default; a chain's, of each sub-beam."""
        named = f"modes = {self.modes}"
        if self.kinematics == "substructured":
            one = Chain(1, self.modes, self.frame, False)
            return [Resolved(named, one.section_angles, True, EXACT)], self.modes + 3
        bends = self._rotations if self.segments == 1 else [PanelBends(self.modes, 1, False)] * 2
        kinds = [Resolved(named, psi, True, TRUNCATED) for psi in bends[: 1 if self.planar else 2]]
        if not self.planar:
            twists = partial(integrated, self.twists) if self.strained else self._torsion
            kinds.append(Resolved(f"twists = {self.twists}", twists, False, EXACT))
        if not self.strained:
            return kinds, 2 * self.modes + 1
        counts = self.strain_counts
        kinds += [Resolved(f"{name} = {n}", partial(legendre, n), True, TRUNCATED) for name, n in counts.items() if n]
        across = self.modes + self.turns + counts["shears"] + 1  # shapes that move the axis the same way, and one
        return kinds, max(2 * self.modes + 1, across, counts["stretches"] + 1)

    @cached_property
    def point_count(self) -> int:
        """Quadrature points, of each sub-beam if "substructured"."""
        if self.points:
            return self.points
        found = enough(*self._resolved)
        if not self.strained:
            return found
        return RestShape(self.rest_curvature, self.beam.length).enough(found, self.segments)

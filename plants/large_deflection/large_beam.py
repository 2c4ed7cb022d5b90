"""A beam that bends as far as it likes: clamped, hinged or driven at its root, a payload and a force at its tip.

States   q = [hub_angle or root_angle where the root turns, bend1 .. bendn], x = [q; dq/dt]; angles in rad. In space
         (planar=False) flaps (about y) and twists follow the bends, which are about z, as is the root's turn
Inputs   tip_force_x, tip_force_y (tip_force_z) [N], inertial axes; with a driven root hub_acceleration [rad/s^2], and
         the tip force is a disturbance
Outputs  tip position, displacement from the straight beam along x and its rate [m, m/s]; rotation of the tip's
         section [rad] and its rate; tip deflection across the root's direction and its rate; the root's angle where it
         turns; curvature about z at the root [1/m]. In space tip_z, its rate, and the tip's twist: past what bending
         brings ("strain"), or the sub-beams' sum
Valid    inextensible and unshearable; sections keep their rotary inertia. "strain": any rotation in the plane, below
         one turn against the root in space. "substructured": rotations within a sub-beam small, see substructure.py
Source   "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Eqs (1)-(39)
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.core.parameters import is_symbolic, quantity, require_choice, require_count, validate
from pliant.plants.core.signals import Sensed, Signal
from pliant.plants.dynamics.lagrangian import LagrangianPlant

from . import tangent_field
from .cross_sections import PlanarSections
from .spatial_sub_beam_chain import SpatialChain
from .spatial_tangent_field import SpatialSections
from .sub_beam_chain import FRAMES, Chain
from .tangent_field import Array, TangentField, Tangents

ROOTS = ("clamped", "hinged", "driven")
KINEMATICS = ("strain", "substructured")
BASES = {"modes": 30, "polynomial": 20}  # basis: most shapes
MOST_SEGMENTS = 32


@dataclass(frozen=True, kw_only=True)
class LargeDeflectionBeam(LagrangianPlant):
    """rho A L^3 W dt/dq . (dt/dq q'' + t'') + rho I L S q'' + (E I/L) K (q + damping q') = gravity + tip force."""

    beam: Beam
    root: str = "clamped"
    gravity: tuple[float, float, float] = quantity("m/s^2", "finite", (0.0, -9.8, 0.0))
    payload: Payload = field(default_factory=Payload)
    kinematics: str = "strain"
    segments: int = 1  # sub-beams ("substructured")
    modes: int = 3  # shapes, of each sub-beam if "substructured"
    frame: str = "mean-axis"  # of each sub-beam ("substructured")
    basis: str = "modes"  # of the rotations ("strain")
    planar: bool = True
    twists: int = 1  # torsion shapes (planar=False)
    points: int | None = None  # quadrature points, of each sub-beam if "substructured"; None: as many as it takes

    def __post_init__(self) -> None:
        validate(self)
        owner = "LargeDeflectionBeam"
        for name, choices in (
            ("root", ROOTS),
            ("kinematics", KINEMATICS),
            ("frame", FRAMES),
            ("basis", tuple(BASES)),
            ("planar", (True, False)),
        ):
            require_choice(owner, name, getattr(self, name), choices)
        if not isinstance(self.gravity, tuple) or len(self.gravity) != 3:
            raise ValueError(f"{owner}.gravity = {self.gravity!r} must be a tuple of 3 numbers [m/s^2]")
        require_count(owner, "modes", self.modes, 1, BASES[self.basis] if self.kinematics == "strain" else 12)
        require_count(owner, "segments", self.segments, 1, MOST_SEGMENTS if self.kinematics != "strain" else 1)
        require_count(owner, "twists", self.twists, 0, 12)
        if self.points is not None:
            require_count(owner, "points", self.points, 2, 64)

    @classmethod
    def textbook(cls) -> Self:
        """The paper's example: a 10 m cantilever, straight along x and at rest, that gravity pulls down from t = 0.

        E = 68.95 GPa, Poisson's ratio 0.33, density 2766.7 kg/m^3, A = 7.3e-5 m^2, I = 8.218e-9 m^4 about y and z.
        """
        E, I = 68.95e9, 8.218e-9
        beam = Beam(length=10.0, area=7.3e-5, I_y=I, I_z=I, J=2 * I, density=2766.7, E=E, G=E / (2 * 1.33))
        return cls(beam=beam)

    @property
    def shape_count(self) -> int:
        """Bending coordinates."""
        return self.modes * self.segments

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        turning = {"clamped": (), "hinged": ("root_angle",), "driven": ("hub_angle",)}[self.root]
        kinds = (("bend", self.modes), ("flap", self.modes), ("twist", self.twists))
        bent = []
        for kind, count in kinds[: 1 if self.planar else 3]:
            own = [str(k + 1) for k in range(count)]
            if self.kinematics == "substructured":
                own = [f"{i + 1}_{k}" for i in range(self.segments) for k in own]
            bent += [kind + k for k in own]
        return tuple(Signal(name, "rad") for name in (*turning, *bent))

    @property
    def _tip_force(self) -> tuple[Signal, ...]:
        return tuple(Signal(f"tip_force_{axis}", "N") for axis in ("xy" if self.planar else "xyz"))

    @property
    def inputs(self) -> tuple[Signal, ...]:
        return (Signal("hub_acceleration", "rad/s^2"),) if self.root == "driven" else self._tip_force

    @property
    def driven(self) -> dict[int, int]:
        return {0: 0} if self.root == "driven" else {}

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        return self._tip_force if self.root == "driven" else ()

    @property
    def outputs(self) -> tuple[Signal, ...]:
        turning = () if self.root == "clamped" else (self.coordinates[0],)
        return (
            *turning,
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
        """An encoder of a root that turns, a strain gauge at one that does not hinge, a gyro at the tip."""
        turning = () if self.root == "clamped" else (Sensed("encoder", self.coordinates[0].name),)
        gauge = Sensed("strain gauge", "root_curvature", scale=1 / self.beam.half_depth)
        return (*turning, *(() if self.root == "hinged" else (gauge,)), Sensed("gyro", "tip_angle_rate"))

    @property
    def deflections(self) -> tuple[str, ...]:
        return ("tip_deflection",)

    @property
    def output_rates(self) -> dict[str, str]:
        moving = ("tip_u", "tip_v", "tip_angle", "tip_deflection", *(() if self.planar else ("tip_z",)))
        return {name: f"{name}_rate" for name in moving}

    @property
    def seen_from(self) -> str | None:
        return "hub_angle" if self.root == "driven" else None

    @property
    def label(self) -> str:
        space = "" if self.planar else f", spatial, twists {self.twists}"
        if self.kinematics == "strain":
            return f"strain, {self.basis} {self.modes}{space}"
        return f"substructured, {self.segments} x {self.modes}, {self.frame}{space}"

    def ladder(self) -> tuple[Self, ...]:
        """Rotation fields with one to eight shapes, chains of sub-beams between them."""
        steps: list[Self] = []
        for kinematics, segments, modes in (
            ("strain", 1, 1),
            ("strain", 1, 2),
            ("substructured", 1, 2),
            ("strain", 1, 3),
            ("strain", 1, 4),
            ("substructured", 2, 2),
            ("substructured", 3, 2),
            ("strain", 1, 6),
            ("substructured", 4, 2),
            ("strain", 1, 8),
        ):
            step = dataclasses.replace(self, kinematics=kinematics, segments=segments, modes=modes, points=None)
            steps.append(step)
        return tuple(steps)

    @cached_property
    def shapes(self) -> tangent_field.Rotations | Chain:
        """What the coordinates turn, from the nominal parameters."""
        if self.kinematics == "substructured":
            return Chain(self.segments, self.modes, self.frame, self.root != "clamped")
        own = self.nominal
        return tangent_field.rotations(self.root, self.basis, self.modes, *own._load_ratios)

    @property
    def _load_ratios(self) -> tuple[float, float]:
        """Payload mass and inertia about the tip, against the beam's m and m L^2."""
        mass, load = self.beam.mass, self.payload
        about_tip = load.inertia_z + load.mass * (load.offset[0] ** 2 + load.offset[1] ** 2)
        return load.mass / mass, about_tip / (mass * self.beam.length**2)

    @cached_property
    def sections(self) -> PlanarSections | SpatialSections | SpatialChain:
        """What the sections add to the axis: rotary inertia, strain energy, the payload's attitude."""
        shapes, own = self.shapes, self.nominal
        if isinstance(shapes, Chain):
            if not self.planar:
                return SpatialChain(self.beam, self.payload, shapes, self.twists, self.points or self.modes + 3)
            turn, inertia = shapes.frame_angles[-1], shapes.inertia()
            return PlanarSections(self.beam, self.payload, shapes.stiffness, inertia, turn)
        at = self._strain_points
        if self.planar:
            turn, inertia = shapes(np.ones(1))[0], shapes.inertia(at)
            return PlanarSections(self.beam, self.payload, shapes.stiffness, inertia, turn)
        flap = tangent_field.rotations("clamped", self.basis, self.modes, *own._load_ratios)
        return SpatialSections(self.beam, self.payload, shapes, flap, self.twists, at)

    @property
    def _root_curvature(self) -> Array:
        """Curvature about z at the root times the length, times q (n,)."""
        shapes, row = self.shapes, np.zeros(len(self.coordinates))
        if isinstance(shapes, Chain):
            row[shapes.columns(0)] = shapes.shapes(0.0, 2)[0] * self.segments
        else:
            row[: shapes.n] = shapes.curvature(np.zeros(1))[0]
        return row

    @property
    def _strain_points(self) -> tangent_field.Points:
        return tangent_field.points(self.points or 2 * self.modes + 1)

    @cached_property
    def tangent_field(self) -> TangentField | SpatialChain:
        """The tangents as functions of q."""
        shapes, sections = self.shapes, self.sections
        if isinstance(sections, SpatialChain):
            return sections
        if isinstance(sections, SpatialSections):
            return sections.field()
        if isinstance(shapes, Chain):
            return shapes.field(self.points or self.modes + 3)
        return tangent_field.planar_field(shapes, self._strain_points)

    @property
    def _loaded(self) -> bool:
        return is_symbolic(self.payload.mass) or self.payload.mass != 0.0

    @property
    def _g(self) -> ca.SX:
        return ca.SX(ca.vertcat(*self.gravity[: 2 if self.planar else 3]))

    def _tip(self, at: Tangents) -> ca.SX:
        return self.beam.length * at.sum(self.tangent_field.points.weight)

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        beam, at = self.beam, self.tangent_field.at(q, v)
        T = beam.mass * beam.length**2 * at.kinetic() + self.sections.kinetic(q, v)
        if self._loaded:
            velocity = beam.length * at.sum_rate(self.tangent_field.points.weight)
            velocity += ca.jtimes(self.sections.carried(q), q, v)
            T += self.payload.mass * ca.sumsqr(velocity) / 2
        return T

    def potential_energy(self, q: ca.SX) -> ca.SX:
        beam, at = self.beam, self.tangent_field.at(q, ca.SX.zeros(q.shape[0]))
        straight = ca.DM.zeros(at.d)
        straight[0] = 1.0
        moved = at.sum(self.tangent_field.points.first_moment) - straight / 2
        fallen = beam.mass * beam.length * moved
        if self._loaded:
            offset = ca.vertcat(*self.payload.offset[: at.d])
            away = self._tip(at) + self.sections.carried(q) - beam.length * straight - offset
            fallen += self.payload.mass * away
        return self.sections.strain_energy(q) - ca.dot(self._g, fallen)

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        return self.sections.dissipation(q, v)

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        tip = self._tip(self.tangent_field.at(q, v))
        return ca.jtimes(tip, q, w if self.root == "driven" else u, True)

    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """What the base class derives from the energies, from the positions' Jacobians: a fraction of the size."""
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        beam, at, points = self.beam, self.tangent_field.at(q, v), self.tangent_field.points
        M, r = self.sections.inertia(q, v)
        M = M + beam.mass * beam.length**2 * at.mass()
        r = r - beam.mass * beam.length**2 * at.inertia_force() + self.sections.elastic_force(q, v)
        r += beam.mass * beam.length * (at.sum_jacobian(points.first_moment).T @ self._g)
        tip = beam.length * at.sum_jacobian(points.weight)
        r += tip.T @ (w if self.root == "driven" else u)
        if self._loaded:
            carried = self.sections.carried(q)
            J = tip + ca.jacobian(carried, q)
            bias = beam.length * at.sum_bias(points.weight) + ca.jtimes(ca.jtimes(carried, q, v), q, v)
            M += self.payload.mass * (J.T @ J)
            r += self.payload.mass * (J.T @ (self._g - bias))
        return M, r, ca.bilin(M, v, v) / 2, self.potential_energy(q)

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        n = x.shape[0] // 2
        q, v = x[:n], x[n:]
        at = self.tangent_field.at(q, v)
        tip, rate = self._tip(at), self.beam.length * at.sum_rate(self.tangent_field.points.weight)
        turning = [] if self.root == "clamped" else [q[0]]
        c, s, turn = (1, 0, 0) if self.root == "clamped" else (ca.cos(q[0]), ca.sin(q[0]), v[0])
        across = c * tip[1] - s * tip[0]
        across_rate = c * rate[1] - s * rate[0] - turn * (c * tip[0] + s * tip[1])
        moved = (tip[0] - self.beam.length, tip[1], rate[:2])
        sections = self.sections
        turned = sections.tip_rotation(q)
        bent = ca.dot(ca.DM(self._root_curvature), q) / self.beam.length
        out = [*turning, tip[:2], *moved, turned, across, across_rate, ca.jtimes(turned, q, v), bent]
        if not isinstance(sections, PlanarSections):
            out += [tip[2], rate[2], sections.tip_twist(q)]
        return ca.vertcat(*out)

    def outline(self, x: Array, points: int = 60) -> Array:
        """The bent beam from root to tip at a state x (nx,): inertial positions (1, points, 2 or 3) [m]."""
        return self.positions(x, np.linspace(0.0, 1.0, points))[None]

    def positions(self, x: Array, xi: Array) -> Array:
        """Positions (k, 2), or (k, 3) in space, [m] of the beam's axis at xi (k,) in [0, 1] at a state x (nx,)."""
        values, batch = self._arguments(x)
        if batch is not None:
            raise ValueError(f"positions takes one state ({self.nx},), not a batch of {batch}")
        t = self.tangent_field.values(values[1][: self.nx // 2])
        own: Any = self.nominal
        return own.beam.length * self.tangent_field.points.cumulative(xi) @ t

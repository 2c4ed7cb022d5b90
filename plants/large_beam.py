"""A beam that bends as far as it likes: clamped, hinged or driven at its root, a payload and a force at its tip.

States   q = [hub_angle or root_angle where the root turns, bend1 .. bendn], x = [q; dq/dt]; angles in rad
Inputs   tip_force_x, tip_force_y [N], inertial axes; with a driven root hub_acceleration [rad/s^2], and the tip
         force is a disturbance
Outputs  tip position, displacement from the straight beam along x and its rate [m, m/s]; rotation of the tip's
         section [rad]; tip deflection across the root's direction and its rate; the root's angle where it turns
Valid    inextensible and unshearable; sections keep their rotary inertia. "strain": any rotation. "substructured":
         rotations within a sub-beam small, see substructure.py
Source   "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Eqs (1)-(39)
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np

from . import strain
from .beams import Beam, Payload
from .lagrange import LagrangianPlant
from .parameters import is_symbolic, quantity, require_choice, require_count, validate
from .signals import Signal
from .strain import Array, TangentField, Tangents
from .substructure import FRAMES, Chain

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
    points: int | None = (
        None  # quadrature points, of each sub-beam if "substructured"; None: as many as it takes
    )

    def __post_init__(self) -> None:
        validate(self)
        owner = "LargeDeflectionBeam"
        for name, choices in (
            ("root", ROOTS),
            ("kinematics", KINEMATICS),
            ("frame", FRAMES),
            ("basis", tuple(BASES)),
            ("planar", (True,)),
        ):
            require_choice(owner, name, getattr(self, name), choices)
        if not isinstance(self.gravity, tuple) or len(self.gravity) != 3:
            raise ValueError(f"{owner}.gravity = {self.gravity!r} must be a tuple of 3 numbers [m/s^2]")
        require_count(owner, "modes", self.modes, 1, BASES[self.basis] if self.kinematics == "strain" else 12)
        require_count(
            owner, "segments", self.segments, 1, MOST_SEGMENTS if self.kinematics != "strain" else 1
        )
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
        if self.kinematics == "strain":
            bent = [f"bend{i + 1}" for i in range(self.modes)]
        else:
            bent = [f"bend{i + 1}_{k + 1}" for i in range(self.segments) for k in range(self.modes)]
        return tuple(Signal(name, "rad") for name in (*turning, *bent))

    @property
    def _tip_force(self) -> tuple[Signal, ...]:
        return Signal("tip_force_x", "N"), Signal("tip_force_y", "N")

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
        )

    @property
    def label(self) -> str:
        if self.kinematics == "strain":
            return f"strain, {self.basis} {self.modes}"
        return f"substructured, {self.segments} x {self.modes}, {self.frame}"

    def ladder(self) -> tuple[Self, ...]:
        """Rotation fields with one to eight shapes, with chains of sub-beams between."""
        steps: list[Self] = []
        for kinematics, segments, modes in (
            ("strain", 1, 1),
            ("strain", 1, 2),
            ("substructured", 1, 2),
            ("strain", 1, 3),
            ("strain", 1, 4),
            ("substructured", 2, 2),
            ("strain", 1, 6),
            ("substructured", 3, 2),
            ("strain", 1, 8),
            ("substructured", 4, 2),
        ):
            steps.append(
                dataclasses.replace(self, kinematics=kinematics, segments=segments, modes=modes, points=None)
            )
        return tuple(steps)

    @cached_property
    def shapes(self) -> strain.Rotations | Chain:
        """What the coordinates turn, from the nominal parameters."""
        if self.kinematics == "substructured":
            return Chain(self.segments, self.modes, self.frame, self.root != "clamped")
        own = self.nominal
        assert isinstance(own, LargeDeflectionBeam)
        mass, load = own.beam.mass, own.payload
        about_tip = load.inertia_z + load.mass * (load.offset[0] ** 2 + load.offset[1] ** 2)
        ratios = (load.mass / mass, about_tip / (mass * own.beam.length**2))
        return strain.rotations(self.root, self.basis, self.modes, *ratios)

    @cached_property
    def tangent_field(self) -> TangentField:
        """The tangents as functions of q."""
        shapes = self.shapes
        if isinstance(shapes, Chain):
            return shapes.field(self.points or self.modes + 3)
        return strain.planar_field(shapes, self.points or 2 * self.modes + 1)

    @cached_property
    def tip_turn(self) -> Array:
        """Rotation of the tip's section = tip_turn . q, (n,)."""
        shapes = self.shapes
        return shapes.frame_angles[-1] if isinstance(shapes, Chain) else shapes(np.ones(1))[0]

    @property
    def _loaded(self) -> bool:
        load = self.payload
        return any(is_symbolic(v) or v != 0.0 for v in (load.mass, load.inertia_z))

    def _carried(self, q: ca.SX) -> ca.SX:
        """The payload's mass centre from the tip (2,) [m], inertial axes."""
        angle = ca.dot(ca.DM(self.tip_turn), q)
        c, s = ca.cos(angle), ca.sin(angle)
        x, y, _ = self.payload.offset
        return ca.vertcat(c * x - s * y, s * x + c * y)

    def _tip(self, at: Tangents) -> ca.SX:
        return self.beam.length * at.sum(self.tangent_field.points.weight)

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        beam, at = self.beam, self.tangent_field.at(q, v)
        T = beam.mass * beam.length**2 * at.kinetic()
        T += beam.density * beam.I_z * beam.length * ca.bilin(ca.DM(self.shapes.inertia), v, v) / 2
        if self._loaded:
            velocity = beam.length * at.sum_rate(self.tangent_field.points.weight)
            velocity += ca.jtimes(self._carried(q), q, v)
            turn = ca.dot(ca.DM(self.tip_turn), v)
            T += self.payload.mass * ca.sumsqr(velocity) / 2 + self.payload.inertia_z * turn**2 / 2
        return T

    def potential_energy(self, q: ca.SX) -> ca.SX:
        beam, at = self.beam, self.tangent_field.at(q, ca.SX.zeros(q.shape[0]))
        points = self.tangent_field.points
        g = ca.vertcat(*self.gravity[:2])
        fallen = beam.mass * beam.length * (at.sum(points.first_moment) - ca.DM([0.5, 0.0]))
        if self._loaded:
            away = self._tip(at) + self._carried(q) - ca.vertcat(beam.length, 0)
            fallen += self.payload.mass * (away - ca.vertcat(*self.payload.offset[:2]))
        return self._strain_energy(q) - ca.dot(g, fallen)

    def _strain_energy(self, q: ca.SX) -> ca.SX:
        return self.beam.EI / self.beam.length * ca.bilin(strain.sparse(self.shapes.stiffness), q, q) / 2

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        return self.beam.damping * self._strain_energy(v)

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        tip = self._tip(self.tangent_field.at(q, v))
        return ca.jtimes(tip, q, w if self.root == "driven" else u, True)

    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """What the base class derives from the energies, from the positions' Jacobians: a fraction of the size."""
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        beam, at, points = self.beam, self.tangent_field.at(q, v), self.tangent_field.points
        inertia = beam.mass * beam.length**2
        M = inertia * at.mass() + beam.density * beam.I_z * beam.length * ca.DM(self.shapes.inertia)
        stiffness = strain.sparse(self.shapes.stiffness)
        r = -inertia * at.inertia_force() - beam.EI / beam.length * (stiffness @ (q + beam.damping * v))
        g = ca.vertcat(*self.gravity[:2])
        r += beam.mass * beam.length * (at.sum_jacobian(points.first_moment).T @ g)
        tip = beam.length * at.sum_jacobian(points.weight)
        r += tip.T @ (w if self.root == "driven" else u)
        if self._loaded:
            turn = ca.DM(self.tip_turn)
            carried, rate = self._carried(q), ca.dot(turn, v)
            J = tip + ca.vertcat(-carried[1], carried[0]) @ turn.T
            bias = beam.length * at.sum_bias(points.weight) - carried * rate**2
            M += self.payload.mass * (J.T @ J) + self.payload.inertia_z * (turn @ turn.T)
            r += self.payload.mass * (J.T @ (g - bias))
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
        moved = ca.vertcat(tip[0] - self.beam.length, tip[1])
        return ca.vertcat(*turning, tip, moved, rate, ca.dot(ca.DM(self.tip_turn), q), across, across_rate)

    def outline(self, x: Array, points: int = 60) -> Array:
        """The bent beam from root to tip at a state x (nx,): inertial positions (1, points, 2) [m]."""
        return self.positions(x, np.linspace(0.0, 1.0, points))[None]

    def positions(self, x: Array, xi: Array) -> Array:
        """Positions (k, 2) [m] of the beam's axis at xi (k,) in [0, 1] at a state x (nx,)."""
        values, batch = self._arguments(x)
        if batch is not None:
            raise ValueError(f"positions takes one state ({self.nx},), not a batch of {batch}")
        t = self._tangents(values[1][: self.nx // 2])
        own: Any = self.nominal
        return own.beam.length * self.tangent_field.points.cumulative(xi) @ t

    def _tangents(self, q: Array) -> Array:
        at = self.tangent_field
        angles = np.column_stack([A @ q for A in at.A])
        function = ca.Function("tangent", [at.angles], [at.tangent]).map(len(angles))
        return np.asarray(function(angles.T)).T

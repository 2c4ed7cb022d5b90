"""What a planar arm of two flexible links is: its parameters, its signals and its shape functions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import casadi as ca
import numpy as np

from pliant.plants import beams
from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.rotating_beam import THEORIES
from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import require_counts
from pliant.plants.core.parameters import flag, part, quantity, require_choice, validate
from pliant.plants.core.signals import Sensed, Signal
from pliant.plants.dynamics.plant_contract import PhysicsContract
from pliant.plants.exact_rotations.planar_chain import PlanarChain
from pliant.plants.exact_rotations.strain_link import StrainLink, elastic_link

from . import physics

REDUCTIONS = ("full", "rigid-inertia", "rigid-coupling", "rigid")
KINEMATICS = ("linear", "stiffened", "strain")
BASES = {"clamped-free": 40, "payload": 40, "polynomial": 20}  # basis: most modes a link


@dataclass(frozen=True, kw_only=True)
class TwoLinkDeclaration(physics.PlanarArm):
    """Links, joints and payload; `TwoLinkArm` adds their energies and loads."""

    link1: Beam = part(Beam)
    link2: Beam = part(Beam)
    joint_mass: float = quantity("kg", "nonnegative", 0.0)  # point mass at joint 2
    payload: Payload = part(Payload, default_factory=Payload)
    hub_inertia: tuple[float, float] = quantity("kg m^2", "nonnegative", (0.0, 0.0), shape=(2,))  # with the link's root
    joint_friction: tuple[float, float] = quantity("N m s/rad", "nonnegative", (0.0, 0.0), shape=(2,))
    gravity: float = quantity("m/s^2", "finite", 9.81)  # along -y
    tip_slope: bool = flag(True)  # the slope of link 1's tip turns link 2 (the paper leaves it out)
    reduction: str = "full"
    kinematics: str = "linear"
    theory: str = "euler-bernoulli"
    extensible: bool = flag(False)
    basis: str = "clamped-free"
    modes: tuple[int, int] = (2, 2)

    def __post_init__(self) -> None:
        validate(self)
        for name, choices in (
            ("reduction", REDUCTIONS),
            ("kinematics", KINEMATICS),
            ("theory", THEORIES),
            ("basis", tuple(BASES)),
        ):
            require_choice("TwoLinkArm", name, getattr(self, name), choices)
        modes = require_counts("TwoLinkArm", "modes", self.modes, 0, BASES[self.basis], length=2)
        object.__setattr__(self, "modes", modes)
        physics.require_stretchable(self)

    @property
    def mode_counts(self) -> tuple[int, int]:
        """Elastic coordinates of bending of each link."""
        return (0, 0) if self.reduction == "rigid" else self.modes

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        n1, n2 = self.mode_counts
        return (
            Signal("theta1", "rad"),
            Signal("theta2", "rad"),
            *(Signal(f"q1{i + 1}", "m") for i in range(n1)),
            *(Signal(f"stretch1{i + 1}", "m") for i in range(self.stretches)),
            *(Signal(f"q2{i + 1}", "m") for i in range(n2)),
            *(Signal(f"stretch2{i + 1}", "m") for i in range(self.stretches)),
        )

    @property
    def inputs(self) -> tuple[Signal, ...]:
        return Signal("tau1", "N m"), Signal("tau2", "N m")

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        return Signal("tip_force_x", "N"), Signal("tip_force_y", "N")

    @property
    def outputs(self) -> tuple[Signal, ...]:
        return (
            Signal("theta1", "rad"),
            Signal("theta2", "rad"),
            Signal("tip1_deflection", "m"),
            Signal("tip2_deflection", "m"),
            Signal("tip1_deflection_rate", "m/s"),
            Signal("tip2_deflection_rate", "m/s"),
            Signal("tip_x", "m"),
            Signal("tip_y", "m"),
            Signal("root1_curvature", "1/m"),
            Signal("root2_curvature", "1/m"),
            Signal("tip_acceleration", "m/s^2"),
        )

    def sensors(self) -> tuple[Sensed, ...]:
        return (
            Sensed("encoder", "theta1"),
            Sensed("encoder", "theta2"),
            Sensed("strain gauge", "root1_curvature", scale=1 / self.link1.half_depth),
            Sensed("strain gauge", "root2_curvature", scale=1 / self.link2.half_depth),
            Sensed("accelerometer", "tip_acceleration"),
        )

    @property
    def deflections(self) -> tuple[str, ...]:
        return "tip1_deflection", "tip2_deflection"

    @property
    def output_rates(self) -> dict[str, str]:
        return {name: f"{name}_rate" for name in self.deflections}

    @property
    def label(self) -> str:
        if self.reduction == "rigid" or self.modes == (0, 0):
            return "rigid"
        stage = "" if self.reduction == "full" else f", {self.reduction}"
        slope = "" if self.tip_slope else ", no tip slope"
        shear = ", shear" if self.theory == "timoshenko" else ""
        return f"{self.kinematics}, {self.basis} {self.modes[0]}+{self.modes[1]}{shear}{self.stretching}{stage}{slope}"

    def physics(self, more: int = 0) -> Self:
        """Exact rotations with shear and rotary inertia on polynomials, `more` than 3 a link."""
        return physics.of_two_links(self, more)

    @property
    def effects(self) -> dict[str, bool]:
        return physics.effects_of_links(self)

    @property
    def planar_chain(self) -> PlanarChain:
        return PlanarChain(
            links=(self.link1, self.link2),
            root="torque",
            turning=("theta1", "theta2"),
            hub_inertia=self.hub_inertia,
            friction=self.joint_friction,
            joint_mass=self.joint_mass,
            payload=self.payload,
            gravity=(0.0, -self.gravity),
            sheared=self.theory == "timoshenko",
        )

    def embedding(self, simpler: PhysicsContract) -> np.ndarray:
        if not isinstance(simpler, TwoLinkDeclaration):
            return super().embedding(simpler)
        return physics.two_embedding(self, simpler)

    @cached_property
    def links(self) -> tuple[ElasticLink, ElasticLink]:
        """Both links with their shape functions, which come from the nominal parameters."""
        own = self.nominal
        n1, n2 = own.mode_counts
        a, b, load = own.link1, own.link2, own.payload
        carried = Payload(mass=own.joint_mass + b.mass + load.mass)  # joint 2 passes no inertia on
        thick = self.theory == "timoshenko"
        first = carried.ratios(a.mass, a.length) | (a.section_ratios if thick else {})
        second = load.ratios(b.mass, b.length) | (b.section_ratios if thick else {})
        shapes1, shapes2 = (
            beams.basis(self.basis, n, stretches=self.stretches, **ratios) for n, ratios in ((n1, first), (n2, second))
        )
        return elastic_link(self.kinematics, self.link1, shapes1), elastic_link(self.kinematics, self.link2, shapes2)

    @property
    def _written_out(self) -> bool:
        return self.reduction in ("full", "rigid") and not isinstance(self.links[0], StrainLink)

    def _split(self, q: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        n1 = self.mode_counts[0] + self.stretches
        return q[0], q[1], q[2 : 2 + n1], q[2 + n1 :]

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        w1, w2, v1, v2 = self._split(v)
        friction = self.joint_friction[0] * w1**2 / 2 + self.joint_friction[1] * w2**2 / 2
        return friction + self.links[0].dissipation(v1) + self.links[1].dissipation(v2)

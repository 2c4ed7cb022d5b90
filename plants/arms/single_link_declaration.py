"""What a single flexible link on a hub is: its parameters, its signals and its shape functions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from pliant.plants import beams
from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.rotating_beam import THEORIES
from pliant.plants.beams.section import Beam
from pliant.plants.core.parameters import flag, part, quantity, require_choice, require_count, validate
from pliant.plants.core.signals import Joint, Sensed, Signal
from pliant.plants.dynamics.plant_contract import PhysicsContract
from pliant.plants.exact_rotations.planar_chain import PlanarChain
from pliant.plants.exact_rotations.strain_link import elastic_link

from . import physics
from .link_frames import FRAMES

KINEMATICS = ("rigid", "linear", "stiffened", "strain")
BASES = {"payload": 40, "clamped-free": 40, "polynomial": 20}  # basis: most modes


@dataclass(frozen=True, kw_only=True)
class SingleLinkDeclaration(physics.PlanarArm):
    """Hub, link and payload; `SingleLinkArm` adds their energies, loads and frames."""

    link: Beam = part(Beam)
    hub_inertia: float = quantity("kg m^2", "nonnegative", 0.0)
    hub_radius: float = quantity("m", "nonnegative", 0.0)  # of the link's root from the axis
    hub_friction: float = quantity("N m s/rad", "nonnegative", 0.0)
    payload: Payload = part(Payload, default_factory=Payload)
    gravity: float = quantity("m/s^2", "finite", 0.0)  # along -y
    kinematics: str = "stiffened"
    theory: str = "euler-bernoulli"
    extensible: bool = flag(False)
    basis: str = "payload"
    modes: int = 2
    frame: str = "clamped"
    drive: str = "torque"

    def __post_init__(self) -> None:
        validate(self)
        for name, choices in (
            ("kinematics", KINEMATICS),
            ("theory", THEORIES),
            ("basis", tuple(BASES)),
            ("frame", FRAMES),
            ("drive", ("torque", "motion")),
        ):
            require_choice("SingleLinkArm", name, getattr(self, name), choices)
        object.__setattr__(self, "modes", require_count("SingleLinkArm", "modes", self.modes, 0, BASES[self.basis]))
        if self.drive == "motion" and self.frame != "clamped":
            raise ValueError(
                f"SingleLinkArm.frame = {self.frame!r} must be 'clamped' where drive = 'motion' prescribes the hub"
            )
        physics.require_stretchable(self)
        if self.kinematics == "strain" and self.frame != "clamped":
            raise ValueError(
                f"SingleLinkArm.frame = {self.frame!r} must be 'clamped' where kinematics = 'strain': only while "
                "slopes are small is a line through the tip or the mass centre turned in proportion to the coordinates"
            )

    @property
    def mode_count(self) -> int:
        """Elastic coordinates of bending."""
        return 0 if self.kinematics == "rigid" else self.modes

    @property
    def coordinates(self) -> tuple[Signal, ...]:
        bent = (Signal(f"eta{i + 1}", "m") for i in range(self.mode_count))
        longer = (Signal(f"stretch{i + 1}", "m") for i in range(self.stretches))
        return Signal("hub_angle" if self.frame == "clamped" else "frame_angle", "rad"), *bent, *longer

    @property
    def inputs(self) -> tuple[Signal, ...]:
        if self.drive == "motion":
            return (Signal("hub_acceleration", "rad/s^2"),)
        return (Signal("hub_torque", "N m"),)

    @property
    def driven(self) -> dict[int, int]:
        return {0: 0} if self.drive == "motion" else {}

    @property
    def disturbances(self) -> tuple[Signal, ...]:
        return Signal("tip_force_x", "N"), Signal("tip_force_y", "N")

    @property
    def outputs(self) -> tuple[Signal, ...]:
        return (
            Signal("hub_angle", "rad"),
            Signal("tip_deflection", "m"),
            Signal("tip_deflection_rate", "m/s"),
            Signal("tip_x", "m"),
            Signal("tip_y", "m"),
            Signal("root_curvature", "1/m"),
            Signal("tip_acceleration", "m/s^2"),
        )

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The first coordinate, in any frame."""
        return (Joint(self.inputs[0].name, *next(iter(self.rates.items()))),)

    def sensors(self) -> tuple[Sensed, ...]:
        return (
            Sensed("encoder", "hub_angle"),
            Sensed("strain gauge", "root_curvature", scale=1 / self.link.half_depth),
            Sensed("accelerometer", "tip_acceleration"),
        )

    @property
    def deflections(self) -> tuple[str, ...]:
        return ("tip_deflection",)

    @property
    def output_rates(self) -> dict[str, str]:
        return {"tip_deflection": "tip_deflection_rate"}

    @property
    def seen_from(self) -> str | None:
        return "hub_angle" if self.frame == "clamped" else None

    @property
    def label(self) -> str:
        if self.mode_count == 0:
            return "rigid"
        shear = ", shear" if self.theory == "timoshenko" else ""
        frame = "" if self.frame == "clamped" else f", {self.frame} frame"
        return f"{self.kinematics}, {self.basis} {self.modes}{shear}{self.stretching}{frame}"

    def physics(self, more: int = 0) -> Self:
        """Exact rotations with shear and rotary inertia on polynomials, `more` than 4."""
        return physics.of_single_link(self, more)

    @property
    def effects(self) -> dict[str, bool]:
        return physics.effects_of_link(self)

    @property
    def planar_chain(self) -> PlanarChain | str:
        if self.hub_radius:
            return "the link's root is off the hub's axis"
        return PlanarChain(
            links=(self.link,),
            root=self.drive,
            turning=("hub_angle",),
            hub_inertia=(self.hub_inertia,),
            friction=(self.hub_friction,),
            payload=self.payload,
            gravity=(0.0, -self.gravity),
            sheared=self.theory == "timoshenko",
        )

    def embedding(self, simpler: PhysicsContract) -> np.ndarray:
        if not isinstance(simpler, SingleLinkDeclaration):
            return super().embedding(simpler)
        own: Any = self
        other: Any = simpler
        return physics.single_embedding(own, other)

    @cached_property
    def elastic(self) -> ElasticLink:
        """The link with its shape functions, which come from the nominal parameters."""
        own = self.nominal
        ratios = own.payload.ratios(own.link.mass, own.link.length)
        if self.theory == "timoshenko":
            ratios |= own.link.section_ratios
        shapes = beams.basis(self.basis, self.mode_count, stretches=self.stretches, **ratios)
        return elastic_link(self.kinematics, self.link, shapes)

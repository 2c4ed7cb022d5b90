"""A machine in the words that every program of planar beams knows: links, joints and what they carry."""

from __future__ import annotations

from dataclasses import dataclass

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam


@dataclass(frozen=True, kw_only=True)
class PlanarChain:
    """Links end to end in the x-y plane, the first from the origin. Sections have rotary inertia; no axis stretches.

    `root`: "clamped", "torque" where an input turns it, "motion" where an input is its acceleration. Every further link
    is turned by an input's torque against the tip of the one before.
    """

    links: tuple[Beam, ...]
    root: str
    turning: tuple[str, ...]  # coordinates: the angle of each joint against the link before [rad]
    hub_inertia: tuple[float, ...]  # of each link's hub, which turns with its root [kg m^2]
    friction: tuple[float, ...]  # of each joint [N m s/rad]
    joint_mass: float = 0.0  # at the second joint [kg]
    payload: Payload
    gravity: tuple[float, float]  # [m/s^2]
    sheared: bool  # whether sections shear, with the links' shear coefficient

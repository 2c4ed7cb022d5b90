"""A scene's machine in the words that every program of planar beams knows, so that each models the same one.

One or two straight links start at rest. The first leaves the origin: clamped, turned by a torque, or turned as
prescribed; the second hangs on a motor at the first one's tip. What is read is the tip's position and the angle of the
first link's root.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Beam, Payload
from pliant.plants.core.signals import index

Array = np.ndarray
STRAIGHT = 1e-9  # largest start of a coordinate that bends, relative to 1 m or 1 rad
ALIKE = "links", "root", "hub_inertia", "friction", "joint_mass", "payload", "gravity", "sheared"  # of a chain
READ = ("tip_x", "tip_y", "tip_u", "tip_v", "tip_deflection", "hub_angle", "theta1")  # compared outputs that are known


class NotModelledError(Exception):
    """Why no program here models a scene, in words."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Machine:
    """Links with their joints and loads. Angles are against the x axis."""

    links: tuple[Beam, ...]
    root: str  # "clamped", "torque" or "motion"
    angles: tuple[float, ...]  # of each link at the start [rad]
    hub_inertia: tuple[float, ...]  # of each link's hub [kg m^2]
    friction: tuple[float, ...]  # of each joint [N m s/rad]
    joint_mass: float  # at the second joint [kg]
    payload: Payload  # its mass centre at the tip
    gravity: tuple[float, float]  # [m/s^2]
    held: Array  # (steps, nu): torques [N m] or the root's acceleration [rad/s^2], over each control period
    dt: float  # control period [s]
    compare: tuple[str, ...]
    sheared: bool  # whether the reference's sections shear

    @property
    def steps(self) -> int:
        """Control periods."""
        return len(self.held)

    @property
    def duration(self) -> float:
        """[s]"""
        return self.steps * self.dt

    @cached_property
    def root_motion(self) -> tuple[Array, Array]:
        """Angle [rad] and rate [rad/s] (steps + 1,) of a root that is turned as prescribed, or stands."""
        still = np.zeros(self.steps + 1)
        if self.root != "motion":
            return still + self.angles[0], still
        a = self.held[:, 0]
        rate = np.concatenate([[0.0], np.cumsum(a * self.dt)])
        turned = np.cumsum(rate[:-1] * self.dt + a * self.dt**2 / 2)
        return self.angles[0] + np.concatenate([[0.0], turned]), rate

    def outputs(self, tip: Array, root_angle: Array) -> Array:
        """The compared outputs (nt, n) of the tip's positions (nt, 2) [m] and the root's angle (nt,) [rad]."""
        x, y = tip.T
        c, s = np.cos(root_angle), np.sin(root_angle)
        length = sum(link.length for link in self.links)
        known = {"tip_x": x, "tip_y": y, "tip_u": x - length, "tip_v": y, "tip_deflection": c * y - s * x}
        known |= {"hub_angle": root_angle, "theta1": root_angle}
        return np.stack([known[name] for name in self.compare], axis=1)


def machine_of(scene: Scene) -> Machine:
    """Of a scene's physics. NotModelledError with the reason where no program here models it."""
    plant: Any = scene.plant.physics().nominal
    chain = plant.planar_chain
    if isinstance(chain, str):
        raise NotModelledError(chain)
    if unknown := [name for name in scene.compare if name not in READ]:
        raise NotModelledError(f"compares {', '.join(unknown)}, which the models here do not give")
    if any(chain.payload.offset[:2]):
        raise NotModelledError("the payload's mass centre is off the tip")
    x, held = scene.with_plant(plant).initial[0], np.array([scene.nominal_input(t) for t in scene.times[:-1]])
    turns = [index(plant.states, name, "state") for name in chain.turning]
    if np.abs(np.delete(x, turns)).max() > STRAIGHT:
        raise NotModelledError("does not start straight and at rest")
    if chain.root == "clamped" and np.any(held):
        raise NotModelledError("a force pulls the tip; the models here are driven at their joints")
    angles = tuple(float(a) for a in np.cumsum(x[turns])) or (0.0,)
    return Machine(
        **{name: getattr(chain, name) for name in ALIKE}, angles=angles, held=held, dt=scene.dt, compare=scene.compare
    )

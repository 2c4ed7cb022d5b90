"""The same turn by several profiles, in open loop: torque, and the vibration that is left.

The inputs are those that take the rigid plant from the scene's start to its goal in the same time; the plant bends. At
the end the rigid motion rests, so that what energy is left above that of the goal is vibration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.controllers import Shaper
from pliant.envs.scenes.scene import Scene
from pliant.plants import Trajectory
from pliant.plants.core.argument_gates import require_count, require_instance, require_names
from pliant.plants.integration.minimum_jerk import PROFILES, profile_of


@dataclass(frozen=True, eq=False)
class Slew:
    """One profile: its motion, the largest input [of its own unit], and the vibration's energy [J]."""

    profile: str
    motion: Trajectory
    largest: float
    energy: np.ndarray  # (nt,) above that of the goal
    left: float  # [J] its mean after the motion has ended; where next to nothing is left rounding may make it negative
    ends: float  # [s]


def compare_slews(
    scene: Scene, profiles: Sequence[str] = tuple(PROFILES), *, shaper: Shaper | None = None, points: int = 1200
) -> tuple[Slew, ...]:
    """The slews of a scene, each in its `move_time` (and the shaper's duration), simulated to its `duration`.

    ValueError where the scene's plant has no rest-to-rest inputs, or `duration` leaves nothing after the motion.

    Example
    -------
    >>> for slew in compare_slews(scene, ("bang-bang", "minimum-jerk")):
    ...     print(slew.profile, slew.largest, slew.left)
    """
    require_instance("compare_slews.scene", scene, Scene)
    names = require_names("compare_slews.profiles", profiles)
    if not names:
        raise ValueError("compare_slews.profiles = () must name at least one profile")
    for name in names:
        profile_of("compare_slews", name)
    if shaper is not None:
        require_instance("compare_slews.shaper", shaper, Shaper)
    points = require_count("compare_slews", "points", points, 2, 10_000_000)
    ends = scene.move_time + (0.0 if shaper is None else shaper.duration)
    if not ends < scene.duration:
        raise ValueError(f"compare_slews.scene: duration = {scene.duration:g} s must be above {ends:g} s, the motion's")
    rigid = scene.with_plant(scene.plant.ladder()[0])
    begin, end = rigid.initial[0], rigid.target[0]
    plant: Any = scene.plant
    if not hasattr(plant, "energy"):
        raise ValueError(f"compare_slews.scene: its plant, {plant.label}, must be mechanical: it has no energy")
    rest = float(plant.energy(scene.target[0]))
    t = np.linspace(0.0, scene.duration, points)
    found = []
    for name in names:
        u = rigid.plant.rest_to_rest(begin, end, scene.move_time, profile=name)
        motion = plant.simulate(scene.initial[0], _shaped(u, shaper), t, rtol=1e-8, atol=1e-10)
        energy = np.asarray(plant.energy(motion.x)) - rest
        left = float(energy[t >= ends].mean())
        found.append(Slew(name, motion, float(np.abs(motion.u).max()), energy, left, ends))
    return tuple(found)


def _shaped(u: Callable[[float], np.ndarray], shaper: Shaper | None) -> Callable[[float], Any]:
    return u if shaper is None else shaper(u)

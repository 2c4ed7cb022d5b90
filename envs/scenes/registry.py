"""The named scenes. Each docstring tables what the scene's environment shows, takes and charges.

An observation is a signal less its value at the goal ("sag": what gravity bends there; "hanging": where the beam
hangs at rest; "speed": the goal's own), which moves in time where the docstring says so; the reward is minus the sum,
over the rows of the cost, of the control period times weight times deviation from the goal squared.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from pliant.plants.core.argument_gates import require_choice, require_number
from pliant.plants.integration.minimum_jerk import minimum_jerk

from . import arms, beams, mechanisms, spacecraft, spacecraft_orbit, trees
from .scene import Scene

__all__ = ["SCENES", "Scene", "get", "minimum_jerk", "names"]

SCENES: Mapping[str, Callable[..., Scene]] = {
    "single-link-slew": arms.single_link_slew,
    "two-link-reach": arms.two_link_reach,
    "cantilever-drop": beams.cantilever_drop,
    "spin-up": beams.spin_up,
    "slider-crank-run": mechanisms.slider_crank_run,
    "flexible-joint-slew": mechanisms.flexible_joint_slew,
    "crane-swing": mechanisms.crane_swing,
    "six-axis-pick": trees.six_axis_pick,
    "three-link-flexible": trees.three_link_flexible,
    "spacecraft-slew": spacecraft.spacecraft_slew,
    "spacecraft-wheels": spacecraft.spacecraft_wheels,
    "spacecraft-spin": spacecraft.spacecraft_spin,
    "spacecraft-orbit": spacecraft_orbit.spacecraft_orbit,
}


def names() -> tuple[str, ...]:
    """The names of all scenes."""
    return tuple(SCENES)


@lru_cache
def _own(name: str) -> Scene:
    """One scene a name, so that what is built from it is built once."""
    return SCENES[name]()


def get(name: str, **overrides: Any) -> Scene:
    """A scene by name; keywords are its own ("spin-up": speed, "spacecraft-spin": axis) or override its fields
    (limits=(80.0, 30.0)).
    """
    require_choice("scenes", "name", name, names())
    own = inspect.signature(SCENES[name]).parameters
    fields = {f.name for f in dataclasses.fields(Scene)}
    for key in overrides:
        require_choice("scenes.get", "keyword", key, sorted(fields | set(own)))
    built = {key: value for key, value in overrides.items() if key in own}
    for key, value in built.items():
        if not isinstance(own[key].default, str):  # else a choice, which the scene checks itself
            built[key] = require_number(f"scene {name!r}: {key}", value, "positive")
    scene = SCENES[name](**built) if built else _own(name)
    changed = {key: value for key, value in overrides.items() if key not in own}
    return dataclasses.replace(scene, **changed) if changed else scene

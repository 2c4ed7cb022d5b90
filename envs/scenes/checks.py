"""What a scene's fields must be: names that its plant knows, numbers within their ranges."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.parameters import unit_of
from pliant.plants.core.signals import index

if TYPE_CHECKING:
    from .scene import Scene

ALLOWED: dict[str, tuple[str, Callable[[float], bool]]] = {
    "start": ("finite", lambda v: True),
    "goal": ("finite", lambda v: True),
    "goal_rates": ("finite", lambda v: True),
    "spreads": ("finite and >= 0", lambda v: v >= 0),
    "bounds": ("finite and > 0", lambda v: v > 0),
    "weights": ("finite and >= 0", lambda v: v >= 0),
}


def check(scene: Scene) -> None:
    """ValueError naming the scene, the field and the value."""
    plant, owner = scene.plant, f"scene {scene.name!r}"
    if len(scene.limits) != plant.nu:
        raise ValueError(f"{owner}: limits = {scene.limits} must hold {plant.nu} numbers > 0")
    for i, (value, signal) in enumerate(zip(scene.limits, plant.inputs)):
        if not (isinstance(value, (int, float)) and 0 < value < np.inf):
            raise ValueError(f"Scene.limits[{i}] = {value!r} must be > 0 [{signal.unit}]")
    if not (isinstance(scene.substeps, int) and scene.substeps >= 1):
        raise ValueError(f"{owner}: substeps = {scene.substeps!r} must be an integer >= 1")
    if scene.steps < 1:
        raise ValueError(f"{owner}: duration = {scene.duration} s must be at least dt = {scene.dt} s")
    known = scene.signals
    for group in ("start", "goal", "goal_rates", "spreads", "bounds", "weights"):
        for name, value in getattr(scene, group):
            index(plant.states if group == "goal_rates" else known, name, f"{owner}: {group}")
            allowed, holds = ALLOWED[group]
            if not (np.isfinite(value) and holds(value)):
                raise ValueError(f"{owner}: {group} {name} = {value} must be {allowed}")
    for name in (*scene.observe, *scene.compare):
        index(known, name, f"{owner}: signal")
    for name, _ in scene.nominal_start or ():
        index(plant.states, name, f"{owner}: nominal_start")
    for name, value in scene.effort:
        index(plant.inputs, name, f"{owner}: effort")
        if not value > 0:
            raise ValueError(f"{owner}: effort {name} = {value} must be > 0")
    for name, value in scene.gusts:
        index(plant.disturbances, name, f"{owner}: gusts")
        if not 0 <= value < np.inf:
            raise ValueError(f"{owner}: gusts {name} = {value} must be finite and >= 0")
    for path, low, high in scene.randomise:
        unit_of(plant, path)
        if not 0 < low <= high:
            raise ValueError(f"{owner}: randomise {path} from {low} to {high} must be 0 < low <= high")

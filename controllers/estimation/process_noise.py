"""What a scene's model does not know, as white noise for a Kalman filter."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.plants.core.argument_gates import require_number

ACTUATOR = 0.01  # of an input's limit: standard deviation of what its actuator is off by in a period


def process_noise(scene: CostedScene) -> dict[str, float]:
    """Densities [unit^2 s] of what is new in every control period, by name of input and disturbance.

    Each actuator is off by 1 % of its limit, and so is each disturbance in an actuator's unit: model error that pushes
    where none of the actuators does. A gust of at most g is uniform in (-g, g), standard deviation g/sqrt(3). Gusts and
    model errors last longer in truth, which the filter then tracks late: give them more density.
    """
    require_scene("process_noise", scene, ("plant", "limits", "dt"))
    plant, gusts = scene.plant, dict(getattr(scene, "gusts", ()))
    found, largest = {}, dict.fromkeys((s.unit for s in plant.inputs), 0.0)
    for signal, limit in zip(plant.inputs, scene.limits):
        found[signal.name] = (ACTUATOR * limit) ** 2 * scene.dt
        largest[signal.unit] = max(largest[signal.unit], limit)
    for signal in plant.disturbances:
        deviation = gusts.get(signal.name, 0.0) / np.sqrt(3) or ACTUATOR * largest.get(signal.unit, 0.0)
        if deviation:
            found[signal.name] = deviation**2 * scene.dt
    return found


def recovering(W: Mapping[str, float], size: Mapping[str, float], recovery: float, dt: float) -> Mapping[str, float]:
    """W with noise besides of standard deviation recovery * size on each input, by name (loop transfer recovery)."""
    q = require_number("LQG.recovery", recovery, "nonnegative")
    return {**W, **{name: W.get(name, 0.0) + (q * one) ** 2 * dt for name, one in size.items()}} if q else W


def scene_noise(scene: CostedScene, W: Mapping[str, float] | None, recovery: float) -> tuple[Mapping[str, float], str]:
    """Densities by name and how they are meant, "held" or "white": those given, or `process_noise`; with `recovering`,
    `recovery` in limits of the inputs."""
    limits = {s.name: limit for s, limit in zip(scene.plant.inputs, scene.limits)}
    given = process_noise(scene) if W is None else W
    return recovering(given, limits, recovery, scene.dt), "held" if W is None else "white"

"""Nominal inputs of a scene: what takes the rigid plant from its start to its goal, or nothing at all."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import Plant, Trajectory

if TYPE_CHECKING:
    from .scene import Scene

Array = np.ndarray
Input = Callable[[float], Array]


def let_go(plant: Plant, t: float) -> Array:
    """No input."""
    return np.zeros(plant.nu)


def minimum_jerk_input(scene: Scene) -> Input:
    """u(t) (nu,) that takes the rigid plant along a minimum-jerk motion in scene.move_time, by inverse dynamics.

    As the plant's `rest_to_rest` says: every joint on its own, a spacecraft about one axis. ValueError where it cannot.
    """
    rigid = scene.plant.ladder()[0]
    played = scene.with_plant(rigid)
    begin, end = played.initial[0], played.target[0]
    try:
        return rigid.rest_to_rest(begin, end, scene.move_time)
    except ValueError as lacking:
        raise ValueError(f"scene {scene.name!r}: drive = None needs {lacking}") from lacking


def steady_motion(scene: Scene) -> Trajectory:
    """The goal as a motion: over one turn where it turns steadily, else at the control times."""
    rates = {abs(rate) for _, rate in scene.goal_rates}
    units = {scene.plant.states[i].unit for i in np.flatnonzero(scene.drift)}
    t = scene.times
    if len(rates) == 1 and units == {"rad"}:
        turn = 2 * np.pi / rates.pop()
        t = np.linspace(0.0, turn, math.ceil(turn / scene.dt) + 1)
    x, u = scene.target
    moved = x + np.multiply.outer(t, scene.drift)
    rows = np.ones((len(t), 1))
    return Trajectory.from_arrays(t, moved, rows * u, plant=scene.plant, dx=rows * scene.drift)

"""Machines that turn, of a scene: its Campbell diagram, and the tongues of a crank's speed.

The speed is the rate that is largest in the scene's goal, or in its start where the goal turns at none. An angle that
turns at it has no part in the modes. A crank that is driven has no rest at a speed: its modes are those of the mean of
A(t) over a turn, and what its changes over the turn do is told by the tongues.
"""

from __future__ import annotations

import dataclasses
from typing import cast

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import LinearModel, Plant
from pliant.plants.core.argument_gates import require_instance, require_number
from pliant.plants.periodic import Campbell, campbell
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.steady_cycles import steady_cycle
from pliant.plants.slider_crank.tongues import Tongue, tongues

SPEEDS = 13  # of a diagram to begin with: modes are followed between them where they change
LEAST = 1e-3  # of the highest speed: where a diagram begins that is asked for from zero, so that modes have shapes
RATE = "rad/s"


def speed_of(scene: Scene) -> str:
    """The state whose value is the speed. ValueError where nothing turns."""
    plant = scene.plant
    units = {s.name: s.unit for s in plant.states}
    goal = {name: abs(value) for name, value in scene.goal if units.get(name) == RATE and value}
    start = {s.name: abs(v) for s, v in zip(plant.states, scene.initial[0], strict=True) if s.unit == RATE and v}
    found = goal or start
    if not found:
        raise ValueError(f"--campbell: nothing turns in scene {scene.name!r}: no rate in its goal or its start")
    return max(found, key=lambda name: found[name])


def campbell_of(scene: Scene, low: float, high: float) -> Campbell:
    """Over the speeds low to high [rad/s]. ValueError where nothing turns or a speed is none."""
    require_instance("campbell_of.scene", scene, Scene)
    low, high = _speeds("--campbell", low, high)
    plant, rate = scene.plant, speed_of(scene)
    speeds = np.linspace(max(low, LEAST * high), high, SPEEDS)
    angles = [name for name, own in plant.rates.items() if own == rate]
    kept = tuple(s.name for s in plant.states if s.name not in {*angles, rate}) if angles else None
    if hasattr(plant, "crank_speed"):
        crank = cast(SliderCrank, plant)
        return campbell(lambda speed: _mean_over_a_turn(crank, speed), speeds, states=kept)
    return campbell(plant, speeds, rate=rate, x0=_at_rest(plant, scene), states=kept)


def tongues_of(scene: Scene, low: float, high: float) -> tuple[Tongue, ...]:
    """The intervals of crank speed [rad/s] in which the cycle is unstable, edges to 1e-4. ValueError for no crank."""
    require_instance("tongues_of.scene", scene, Scene)
    low, high = _speeds("--tongues", low, high)
    return tongues(cast(SliderCrank, scene.plant), low, high)  # which asks


def _at_rest(plant: Plant, scene: Scene) -> np.ndarray:
    """The start without its rates."""
    rates = {s.name for s in plant.states if s.unit == RATE} | set(plant.rates.values())
    return np.array([0.0 if s.name in rates else v for s, v in zip(plant.states, scene.initial[0], strict=True)])


def _mean_over_a_turn(plant: SliderCrank, speed: float) -> LinearModel:
    driven = plant if plant.crank_speed is not None else dataclasses.replace(plant, crank_speed=speed)
    along = driven.linearize_along(steady_cycle(driven, speed=speed))
    return dataclasses.replace(along.at(0), A=along.A[:-1].mean(axis=0), f0=np.zeros(len(along.states)))


def _speeds(option: str, low: float, high: float) -> tuple[float, float]:
    low, high = (
        require_number(f"{option} {word}", value, "nonnegative", RATE) for word, value in (("LOW", low), ("HIGH", high))
    )
    if not high > low:
        raise ValueError(f"{option} {low:g} {high:g} must rise")
    return low, high

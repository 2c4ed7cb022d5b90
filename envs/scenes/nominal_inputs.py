"""Nominal inputs of a scene: what takes the rigid plant from its start to its goal, or nothing at all."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import NominalWarning, Plant, Trajectory
from pliant.plants.core.errors import warn_caller
from pliant.plants.dynamics.equilibrium import growth_at_rest

if TYPE_CHECKING:
    from .scene import Scene

Array = np.ndarray
Input = Callable[[float], Array]
FAR = 0.25  # of the way: what bends swings by a tenth about where its rigid model arrives
SLOW = 1e-6  # [the state's unit/s] of a start that is given, and at rest
MOST = 2000  # control times at which inputs are held against their limits


def let_go(plant: Plant, t: float) -> Array:
    """No input."""
    return np.zeros(plant.nu)


def nominal_input(scene: Scene) -> Input:
    """The scene's drive, or what takes the rigid plant from start to goal. Warns (NominalWarning) beyond its limits."""
    found: Input = minimum_jerk_input(scene) if scene.drive is None else partial(scene.drive, scene.plant)
    if beyond := beyond_limits(scene, found):
        more = "" if scene.drive is not None else "; a longer move_time needs less"
        warn_caller(f"the nominal inputs of scene {scene.name!r} are beyond its limits: {beyond}{more}", NominalWarning)
    return found


def sampled(scene: Scene, inputs: Input) -> tuple[Array, Array]:
    """(times (n,), inputs (n, nu)) at the scene's control times, at most MOST of them."""
    times = scene.times[:: math.ceil(len(scene.times) / MOST)]
    at_once: Callable[[Array], Array] | None = getattr(inputs, "at_times", None)
    return times, at_once(times) if at_once else np.array([inputs(float(t)) for t in times])


def beyond_limits(scene: Scene, inputs: Input) -> str:
    """Which inputs leave the scene's limits at its control times: by name, value and limit; "" where none does."""
    times, u = sampled(scene, inputs)
    if u.shape != (len(times), scene.plant.nu):
        return ""  # a drive that gives something else is refused where it is played
    return largest_beyond(scene, times, u)


def largest_beyond(scene: Scene, times: Array, u: Array) -> str:
    """Which inputs u (n, nu) at times (n,) leave the scene's limits, the largest of each; "" where none does."""
    at = np.abs(u).argmax(axis=0)
    return ", ".join(
        f"{s.name} = {u[k, i]:.4g} {s.unit} at {times[k]:.3g} s (limit {limit:g})"
        for i, (k, s, limit) in enumerate(zip(at, scene.plant.inputs, scene.limits, strict=True))
        if abs(u[k, i]) > limit
    )


def told(scene: Scene, motion: Trajectory) -> Trajectory:
    """The open-loop motion itself. Warns (NominalWarning) where it ends far from the goal that it was made for."""
    if words := far_from_goal(scene, motion):
        held = f"; {unheld(scene)}" if unheld(scene) else ""
        warn_caller(f"the open-loop motion of scene {scene.name!r} does not arrive: {words}{held}", NominalWarning)
    return motion


def unheld(scene: Scene) -> str:
    """Why a motion made from rest to rest does not arrive by itself, in words: start or goal are rests that only a
    feedback holds, or the start is none. "" where there is no such reason.
    """
    if not scene.start_at_rest and np.abs(scene.plant.dynamics(*scene.initial)).max() > SLOW:
        return "it does not start at rest"
    ends = (("start", scene.start_at_rest, scene.initial), ("goal", scene.goal_at_rest, scene.target))
    left = [name for name, at_rest, (x, u) in ends if at_rest and growth_at_rest(scene.plant, x, u)]
    return f"its {' and '.join(left)} must be held by a feedback" if left else ""


def far_from_goal(scene: Scene, motion: Trajectory) -> str:
    """Which goals a motion from rest to rest misses by more than a quarter of the longest way in their unit; "" where
    none, or where another drive, a moving goal or too short a duration leaves nothing to say.
    """
    if scene.drive is not None or scene.goal_rates or motion.t[-1] < scene.move_time:
        return ""
    names = tuple(name for name, _ in scene.goal if name not in scene.plant.attitude_states)
    wanted, found = scene.goal_values(names), np.array([motion[name][[0, -1]] for name in names]).reshape(-1, 2)
    units = [scene.signals[i].unit for i in scene.positions(names)]
    ways = np.abs(wanted - found[:, 0])
    longest = {unit: max(way for way, own in zip(ways, units) if own == unit) for unit in units}
    return ", ".join(
        f"{name} ends at {end:.4g} {unit}, not at {goal:.4g}"
        for name, unit, goal, end in zip(names, units, wanted, found[:, 1])
        if longest[unit] > 0 and not abs(end - goal) <= FAR * longest[unit]
    )


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

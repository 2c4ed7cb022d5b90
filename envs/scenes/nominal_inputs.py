"""Nominal inputs of a scene: what takes the rigid plant from its start to its goal, or nothing; a goal that moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants import FlexibleSpacecraft, Plant, Trajectory
from pliant.plants.core.minimum_jerk import minimum_jerk
from pliant.plants.core.quaternions import product
from pliant.plants.spacecraft.environment import Environment

if TYPE_CHECKING:
    from .scene import Scene

Array = np.ndarray
Input = Callable[[float], Array]


def let_go(plant: Plant, t: float) -> Array:
    """No input."""
    return np.zeros(plant.nu)


def minimum_jerk_input(scene: Scene) -> Input:
    """u(t) (nu,) that takes the rigid plant along a minimum-jerk motion in scene.move_time, by inverse dynamics.

    Every joint moves on its own; a spacecraft turns about one axis fixed in it (an eigenaxis slew).
    """
    if isinstance(scene.plant, FlexibleSpacecraft):
        return _slew(scene)
    rigid = scene.plant.ladder()[0]
    n = rigid.nx // 2
    begin, end = (np.array([dict(g).get(s.name, 0.0) for s in rigid.states[:n]]) for g in (scene.start, scene.goal))
    still, held = np.zeros(rigid.nu), list[Array]()  # held: the input at the end, once it is known

    def torque(t: float) -> Array:
        if t >= scene.move_time and held:
            return held[0].copy()
        s, ds, dds = minimum_jerk(t / scene.move_time)
        x = np.concatenate([begin + (end - begin) * s, (end - begin) * ds / scene.move_time])
        wanted = (end - begin) * dds / scene.move_time**2
        free = rigid.dynamics(x, still)[n:]
        B = rigid.jacobians(x, still)[1][n:]
        u = np.linalg.solve(B, wanted - free)
        if t >= scene.move_time:
            held.append(u.copy())
        return u

    return torque


def _slew(scene: Scene) -> Input:
    """From the attitude at the start to that at the goal, at rest at both, hinges as at the start.

    Without loads and wheels the rigid equations are J d(omega)/dt + omega x J omega = torque at any attitude, so that
    the inputs are a share of the angle's acceleration and one of its rate squared.
    """
    craft = scene.plant.ladder()[0]
    assert isinstance(craft, FlexibleSpacecraft)
    if craft.environment != Environment() or craft.hub.wheels:
        raise ValueError(f"scene {scene.name!r}: drive = None needs a spacecraft without loads and wheels")
    at, x = craft.layout, scene.with_plant(craft).initial[0].copy()
    begin, end = x[at.quaternion], scene.with_plant(craft).target[0][at.quaternion]
    turn = _rotation_vector(product(begin * [1.0, -1.0, -1.0, -1.0], end))  # in body axes
    x[at.omega] = turn
    B = craft.jacobians(x)[1][at.omega]
    speeding, turning = (np.linalg.lstsq(B, v, rcond=None)[0] for v in (turn, -craft.dynamics(x)[at.omega]))
    T = scene.move_time

    def torque(t: float) -> Array:
        _, ds, dds = minimum_jerk(t / T)
        return speeding * (dds / T**2) + turning * (ds / T) ** 2

    return torque


def _rotation_vector(q: Array) -> Array:
    """The shorter turn (3,) [rad] of a unit quaternion (4,)."""
    q = -q if q[0] < 0 else q
    size = np.linalg.norm(q[1:])
    return 2 * np.arctan2(size, q[0]) * q[1:] / size if size > 0 else np.zeros(3)


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

"""What Newton's method on a motion asks of its models: of the fine one what the motion lacks of being one, its mass
matrices and outputs, of the simple one its motion at all nodes.

Mechanical plants are asked at the motion's own accelerations a: the forces r - M a that their equations lack take
a fraction of the operations of M^-1 r - a, and vanish with it. What a pass makes of them needs no more than a mass
matrix near by.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.plants import Plant, Trajectory
from pliant.plants.core.signals import index
from pliant.studies.common.reference_motions import Motions

from .motion_nodes import MotionNodes

Array = np.ndarray
BEYOND = 1e9  # of a state: nothing moves so
ENDS = 1e-4  # of the largest value of a state: how near a motion between control times must come to the next of them


def start_of(motions: Motions, fine: Plant) -> Array:
    """Where a fine model starts (nx,): a rest is found by the balance of forces, which passes are going to need."""
    _ = fine.force_balance
    return motions.start(fine)


def compared(motions: Motions, plant: Plant) -> list[int]:
    """Where the compared outputs stand in [y; x]."""
    return [index((*plant.outputs, *plant.states), name, "output or state") for name in motions.scene.compare]


def lacking(fine: Plant, t: Array, x: Array, u: Array, rate: Array, inverse: Array | None) -> Array:
    """f(x, u) - dx/dt (k, nx) at points, or what vanishes with it: with `inverse` mass matrices (k, m, m) these times
    the forces that the equations of motion lack.
    """
    balance = fine.force_balance
    if balance is None or inverse is None:
        return np.asarray(fine.dynamics(x, u, t=t)) - rate
    n, c = balance.first, np.empty_like(x)
    a = rate[:, n:]
    c[:, :n] = balance.rates(x) - rate[:, :n]
    for i, k in balance.driven.items():
        c[:, n + i] = u[:, k] - a[:, i]
    c[:, [n + i for i in balance.free]] = (inverse @ balance.lacking(t, x, u, a)[..., None])[..., 0]
    return c


def masses(fine: Any, t: Array, x: Array, u: Array) -> Array | None:
    """Mass matrices (k, m, m) at points of a mechanical plant; MassMatrixError where one is not definite."""
    balance = fine.force_balance
    if balance is None:
        return None
    M = balance.mass(t, x, u)
    if np.isfinite(M).all():
        fine.check_definite(x, np.linalg.eigvalsh(M).min(axis=1, initial=np.inf))
    return np.asarray(M)


def jacobians(fine: Any, t: Array, x: Array, u: Array, rate: Array, M: Array | None) -> Array:
    """A (k, nx, nx) at points and their rates, for Newton's method: of mechanical plants nearly, with masses M."""
    balance = fine.force_balance
    if balance is not None:
        return np.asarray(balance.near_jacobians(t, x, u, rate[:, balance.first :], M))
    if len(t) == 1:  # a motion has two times
        x, u, rate = (np.repeat(v, 2, axis=0) for v in (x, u, rate))
        return jacobians(fine, np.append(t, t + 1.0), x, u, rate, M)[:1]
    y = np.zeros((len(t), fine.ny))  # unused
    return np.asarray(fine.state_jacobians_along(Trajectory.from_arrays(t, x, u, plant=fine, y=y, dx=rate)))


def outputs(fine: Any, t: Array, x: Array, u: Array, asked: Sequence[int]) -> Array:
    """y (k, ny) at points; of outputs that depend on accelerations only those `asked` for are known to be right."""
    balance = fine.force_balance
    if balance is None:
        return np.asarray(fine.measure(x, u, t=t))
    felt = fine.feels_accelerations
    unfelt = not any(felt[k] for k in asked if k < len(felt))
    a = np.zeros((len(x), balance.n)) if unfelt else balance.accelerations(t, x, u, masses(fine, t, x, u))
    return np.asarray(fine.measure_at(t, x, u, a))


def trajectory(fine: Any, t: Array, x: Array, u: Array) -> Trajectory:
    """Points (k, nx) of a motion as one."""
    balance = fine.force_balance
    if balance is None:
        return Trajectory.from_arrays(t, x, u, plant=fine, dx=fine.dynamics(x, u, t=t))
    a = balance.accelerations(t, x, u, masses(fine, t, x, u))
    dx = np.hstack([balance.rates(x), a])
    return Trajectory.from_arrays(t, x, u, plant=fine, y=fine.measure_at(t, x, u, a), dx=dx)


def between_control_times(simple: Plant, motion: Trajectory, nodes: MotionNodes) -> Trajectory | None:
    """A motion that is known at the control times at all nodes: in all periods at once, from node to node by RK4; None
    where that does not end where the next period begins.
    """
    h, start = np.diff(nodes.times), np.arange(0, len(nodes.all) - 1, 3 * nodes.parts)
    x = np.empty((len(nodes.all), simple.nx))
    x[nodes.ends[nodes.control]] = motion.x
    here, u = motion.x[:-1], nodes.held[:-1]
    with np.errstate(all="ignore"):
        for k in range(3 * nodes.parts):
            t = nodes.all[start + k]
            here = _stepped(simple, t, here, u, nodes.all[start + k + 1] - t)
            if not (np.abs(here) < BEYOND).all():
                return None
            if k + 1 < 3 * nodes.parts:
                x[start + k + 1] = here
    size = np.abs(motion.x).max(axis=0) + np.abs(h).max() * np.abs(motion.derivative()).max(axis=0)
    if (np.abs(here - motion.x[1:]) > ENDS * size).any():
        return None
    dx = simple.dynamics(x, nodes.inputs, t=nodes.all)
    y = np.zeros((len(x), simple.ny))  # unused
    return Trajectory.from_arrays(nodes.all, x, nodes.inputs, plant=simple, y=y, dx=dx)


def _stepped(plant: Plant, t: Array, x: Array, u: Array, h: Array) -> Array:
    """A step of RK4 of each row; no numbers where one of its stages has none."""
    slopes = [plant.dynamics(x, u, t=t)]
    for share in (0.5, 0.5, 1.0):
        stage = x + share * h[:, None] * slopes[-1]
        if not np.isfinite(stage).all():
            return stage
        slopes.append(plant.dynamics(stage, u, t=t + share * h))
    k1, k2, k3, k4 = slopes
    return np.asarray(x + h[:, None] / 6 * (k1 + 2 * k2 + 2 * k3 + k4))

"""What Newton's method on a motion asks of the fine model: what the motion lacks of being one, mass matrices, outputs.

Of mechanical plants it is asked at the motion's own accelerations a: the forces r - M a that their equations lack take
a fraction of the operations of M^-1 r - a, and vanish with it. What a pass makes of them needs no more than a mass
matrix near by.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.plants import Plant, Trajectory

Array = np.ndarray


def lacking(fine: Plant, t: Array, x: Array, u: Array, rate: Array, inverse: Array | None) -> Array:
    """f(x, u) - dx/dt (k, nx) at points, or what vanishes with it: with `inverse` mass matrices (k, m, m) these times
    the forces that the equations of motion lack.
    """
    balance = fine.force_balance
    if balance is None or inverse is None:
        return np.asarray(fine.dynamics(x, u, t=t)) - rate
    n, c = balance.n, np.empty_like(x)
    a = rate[:, n:]
    c[:, :n] = x[:, n:] - rate[:, :n]
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
    dx = np.hstack([x[:, balance.n :], a])
    return Trajectory.from_arrays(t, x, u, plant=fine, y=fine.measure_at(t, x, u, a), dx=dx)

"""Linear models of plants with quaternions in small deviations: about a state, along any nominal, over an impulse."""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import Any

import numpy as np

from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.linear_models import at_point, check_signals, finer
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

Array = np.ndarray
TURN = 1e-3  # [rad] that attitudes may be apart at a jump, of which the map is of first order


def linearize(plant: Any, x0: Any, u0: Any, w: Any, p: Any, t: float) -> LinearModel:
    """About (x0, u0) frozen; where an attitude turns there, its turns are measured from the turning attitude."""
    point, at = at_point(plant, x0, u0, w, p, t), plant.small
    plant.check_state(point.x)
    f0 = at.rows(point.x, point.dx[:, None])[:, 0]
    for a in at.attitudes:
        f0[at.turn(a)] = 0.0
    A, B, E, C, D, F = at.model(point.x, point.dx, point.jacobians)
    return LinearModel(
        *(A, B, E, C, D, F),
        states=plant.deviations,
        inputs=plant.inputs,
        disturbances=plant.disturbances,
        outputs=plant.outputs,
        x0=at.cut(point.x),
        u0=point.u,
        w0=point.w,
        y0=point.y,
        f0=f0,
    )


def check_nominal(plant: Any, nominal: Trajectory) -> None:
    """ValueError where a quaternion of a nominal is not of unit length, or changes its sign and so has no rate."""
    plant.check_state(nominal.x)
    for a in plant.attitudes:
        q = nominal.x[:, a.quaternion]
        flips = np.flatnonzero((q[1:] * q[:-1]).sum(axis=1) < 0)
        if nominal.dx is None and len(flips):
            raise ValueError(
                f"nominal: the quaternion{a.of} changes its sign at t = {nominal.t[flips[0] + 1]:.6g} s; keep "
                "neighbours on one side (q and -q are the same attitude), or give dx"
            )


def along(plant: Any, nominal: Trajectory, p: Any) -> LTVModel:
    """About a nominal motion, at its own accelerations as any mechanical plant; its residual is the affine term c."""
    check_signals(plant, nominal)
    check_nominal(plant, nominal)
    between = partial(finer, partial(_between_nodes, plant), _of_one_sign(plant, nominal), p)
    return dataclasses.replace(_at_nodes(plant, nominal, p), between=between)


def _of_one_sign(plant: Any, nominal: Trajectory) -> Trajectory:
    """The same attitudes with quaternions that go on as their rates tell, where they changed their sign."""
    if nominal.dx is None:
        return nominal
    x, dx, half = nominal.x.copy(), nominal.dx.copy(), np.diff(nominal.t)[:, None] / 2
    for a in plant.attitudes:
        q = a.quaternion
        on, back = (
            np.linalg.norm(s * (x[1:, q] - half * dx[1:, q]) - (x[:-1, q] + half * dx[:-1, q]), axis=1) for s in (1, -1)
        )
        sign = np.cumprod(np.concatenate([[1.0], np.where(back < on, -1.0, 1.0)]))[:, None]
        x[:, q], dx[:, q] = sign * x[:, q], sign * dx[:, q]
    return dataclasses.replace(nominal, x=x, dx=dx)


def _between_nodes(plant: Any, motion: Trajectory, p: Any) -> LTVModel:
    """Where the polynomials of a quaternion leave the unit sphere."""
    return _at_nodes(plant, dataclasses.replace(motion, x=plant.consistent(motion.x)), p)


def _at_nodes(plant: Any, nominal: Trajectory, p: Any) -> LTVModel:
    w = nominal.w if nominal.w is not None else np.zeros((len(nominal.t), plant.nw))
    dx, at = nominal.derivative(), plant.small
    A, B, E, C, D, F = at.model(nominal.x, dx, plant._jacobians_along(nominal, w, p))
    residual = plant.dynamics(nominal.x, nominal.u, w=w, p=p, t=nominal.t) - dx
    return LTVModel(
        *(nominal.t, A, B, E, C, D, F),
        c=at.rows(nominal.x, residual[..., None])[..., 0],
        x=at.cut(nominal.x),
        u=nominal.u,
        w=w,
        y=plant.measure(nominal.x, nominal.u, w=w, p=p, t=nominal.t),
        states=plant.deviations,
        inputs=plant.inputs,
        disturbances=plant.disturbances,
        outputs=plant.outputs,
    )


def jump(plant: Any, x: Array, after: Array, jumped: tuple[Array, Array], t: float) -> tuple[Array, Array]:
    """(J, j) of a jump from x (nx,) to `after` (nx,), of deviations; ValueError where an attitude jumps too."""
    for a in plant.attitudes:
        turn = 2 * np.arccos(min(1.0, abs(float(x[a.quaternion] @ after[a.quaternion]))))
        if turn > TURN:
            raise ValueError(
                f"linearize_pieces: the attitude{a.of} jumps by {turn:.3g} rad at t = {t:.6g} s, must not jump"
            )
    (J, j), x, after = jumped, np.asarray(x, dtype=float), np.asarray(after, dtype=float)
    return plant.small.rows(after, plant.small.columns(x, J)), plant.small.rows(after, j[:, None])[:, 0]

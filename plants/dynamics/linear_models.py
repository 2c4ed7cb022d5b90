"""Linear models of a plant: about a point, along any nominal motion, and over an impulse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.signals import names
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

if TYPE_CHECKING:
    from .plant import Plant

Array = np.ndarray


def about(plant: Plant, x0: Any, u0: Any, w: Any, p: Any, t: float) -> LinearModel:
    """The model at one point, f0 the rate there."""
    (_, x, u, w, p), _ = plant._arguments(x0, u0, w, p, t)
    if x.ndim != 1:
        raise ValueError(f"{type(plant).__name__}.x has shape {x.shape}, must be ({plant.nx},) to linearise")
    A, B, E, C, D, F = plant.jacobians(x, u, w=w, p=p, t=t)
    return LinearModel(
        *(A, B, E, C, D, F),
        states=plant.states,
        inputs=plant.inputs,
        disturbances=plant.disturbances,
        outputs=plant.outputs,
        x0=x,
        u0=u,
        w0=w,
        y0=plant.measure(x, u, w=w, p=p, t=t),
        f0=plant.dynamics(x, u, w=w, p=p, t=t),
    )


def check_signals(plant: Plant, nominal: Trajectory) -> None:
    """ValueError where a nominal is not given in the plant's states and inputs."""
    for name, have, want in (
        ("states", nominal.states, plant.states),
        ("inputs", nominal.inputs, plant.inputs),
    ):
        if names(have) != names(want):
            raise ValueError(f"nominal.{name} = {names(have)} must be {names(want)}")


def along(plant: Plant, nominal: Trajectory, p: Any) -> LTVModel:
    """The model at the nodes of a nominal, c its residual f(x, u) - dx/dt."""
    check_signals(plant, nominal)
    w = nominal.w if nominal.w is not None else np.zeros((len(nominal.t), plant.nw))
    rate = plant.dynamics(nominal.x, nominal.u, w=w, p=p, t=nominal.t)
    A, B, E, C, D, F = plant._jacobians_along(nominal, w, p)
    return LTVModel(
        *(nominal.t, A, B, E, C, D, F),
        c=rate - nominal.derivative(),
        x=nominal.x,
        u=nominal.u,
        w=w,
        y=plant.measure(nominal.x, nominal.u, w=w, p=p, t=nominal.t),
        states=plant.states,
        inputs=plant.inputs,
        disturbances=plant.disturbances,
        outputs=plant.outputs,
    )


def over_impulse(plant: Plant, x: Array, after: Array, P: Array, p: Any, t: float) -> tuple[Array, Array]:
    """(J (nx, nx), j (nx,)) of dx+ = J dx- + j, where a nominal goes from x (nx,) to `after` (nx,) in an impulse P
    (nu,) [input units times s].
    """
    still = np.zeros(plant.nu)
    moved = plant.dynamics(x, P, p=p, t=t) - plant.dynamics(x, still, p=p, t=t)
    J = np.eye(plant.nx) + plant.jacobians(x, P, p=p, t=t)[0] - plant.jacobians(x, still, p=p, t=t)[0]
    return J, moved - (after - x)

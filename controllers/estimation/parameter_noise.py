"""What errors of a plant's parameters push, told to a Kalman filter as process noise.

An error dp of a parameter moves the rates of the states by (df/dp) dp and the readings by (dh/dp) dp, as long as the
machine moves: an error that a filter for actuators' noise alone does not know, so that it trusts modes whose
frequencies are not those of its model. Along a scene's motion under a state feedback what is pushed has a covariance; a
share of it is taken as noise that is new in each period: parameter-robust LQG ("Parameter robust linear quadratic
Gaussian design synthesis with flexible structure control applications", Tahk and Speyer 1987, where constant errors are
stood for by white noise and the shares are left to the designer).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.controllers.base.goal_model import away
from pliant.controllers.base.scene_protocol import CostedScene
from pliant.plants.core import parameters
from pliant.plants.core.signals import Signal, names, rows_by_name
from pliant.plants.linear.lti import LinearModel

from .kalman import Kalman
from .sensors import Sensor

Array = np.ndarray
LEAST = 1e-3  # of the largest direction that a parameter pushes in: below it none is told


def uncertain_box(scene: CostedScene, spread: float) -> dict[str, tuple[float, float]]:
    """Factors (1 - spread, 1 + spread) by name of what the scene's plant calls uncertain and is not zero."""
    plant: Any = scene.plant
    return {path: (1.0 - spread, 1.0 + spread) for path in plant.uncertain if parameters.get(plant, path)}


def linear_motion(scene: CostedScene, model: LinearModel, K: Array) -> Array:
    """[x; u; 1] (nx + nu + 1, steps) from a scene's start to its goal, from which x and u count, under u = -K x.

    `model` is the scene plant's feedback model at the goal, K (nu, nx).
    """
    held, x, found = model.discretize(scene.dt), away(scene, model), []
    for _ in range(scene.steps):
        u = -K @ x
        found.append(np.concatenate([x, u, [1.0]]))
        x = held.A @ x + held.B @ u
    return np.array(found).T


def pushed(
    scene: CostedScene, model: LinearModel, box: Mapping[str, tuple[float, float]], K: Array
) -> tuple[Array, ...]:
    """For each parameter of `box` a root (nx + ny, k) of the covariance of what its error moves rates and readings by.

    About the goal, along `linear_motion`. A parameter is uniform in its range.
    """
    varied, whole, found = scene.plant.vary(*box), linear_motion(scene, model, K), []
    for i, (low, high) in enumerate(box.values()):
        p = varied.nominal_parameters.copy()
        p[i] *= 1 + (high - low) / 2
        other = varied.feedback_model(*scene.target, p=p)
        both = [
            np.block([[m.A, m.B, m.f0[:, None]], [m.C, m.D, m.y0[:, None]]]) @ whole / np.sqrt(3 * scene.steps)
            for m in (other, model)  # uniform over the range: its deviation is half of it over the root of three
        ]
        directions, size, _ = np.linalg.svd(both[0] - both[1], full_matrices=False)
        found.append((directions * size)[:, size > LEAST * max(size[0], 1e-300)])
    return tuple(found)


def off_by(sensors: Sequence[Sensor], model: LinearModel, motion: Array, share: float) -> tuple[Sensor, ...]:
    """The sensors with errors besides of `share` of what each reads in a `linear_motion`: the model's, in truth."""
    _, C, D, _ = rows_by_name(model, [sensor.output for sensor in sensors])
    ranges = np.ptp(np.hstack([C, D]) @ motion[:-1], axis=1)
    return tuple(replace(s, noise=float(np.hypot(s.noise, share * r))) for s, r in zip(sensors, ranges))


def told_parameters(
    plain: Kalman,
    sensors: Sequence[Sensor],
    roots: Sequence[Array],
    W: Mapping[str, float],
    noise: str,
    dt: float,
) -> Kalman:
    """The filter that takes roots (nx + ny, k) of covariances for noise new in each period dt [s], beside W.

    sensors: as the filter takes them to be; W, noise: as of `Kalman.design`. Its delays, first estimate, model and the
    sensors that it tells of are those of `plain`, about a point.
    """
    model, nx = plain.model, len(plain.model.states)
    assert isinstance(model, LinearModel)
    root = np.hstack(list(roots))
    own = tuple(Signal(f"parameters {k + 1}", "1") for k in range(root.shape[1]))
    wide = replace(
        model,
        E=np.hstack([model.E, root[:nx]]),
        F=np.hstack([model.F, root[nx:]]),
        disturbances=model.disturbances + own,
        w0=np.append(model.w0, np.zeros(root.shape[1])),
    )
    density = {**W, **dict.fromkeys(names(own), dt)}
    delay, late = plain.delay, plain.input_delay
    made = Kalman.design(wide, sensors, density, dt=dt, noise=noise, delay=delay, input_delay=late)
    return replace(made, model=model, sensors=plain.sensors, start=plain.start, before=plain.before)

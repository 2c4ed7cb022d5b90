"""LQG that lasts over a box of parameters: what uncertain parameters push, told to its filter as process noise.

Noise    of what an error of a parameter pushes along the scene's motion under its LQR the filter takes a share r_i, and
         a share a of the actuators' noise (`parameter_noise`)
Search   shares and the price of inputs by the simplex method of Nelder and Mead (1965) on the mean of the scene's cost
         over the corners of the box, each with each of the delays: linear about the goal, sensors with their noise

What is found is an LQG: the optimum for its noises, stable on its own model. Noise on the inputs alone (loop transfer
recovery) brings back the margins at the inputs, which is not where payload and stiffness err.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import minimize

from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.parameter_noise import pushed, told_parameters
from pliant.controllers.estimation.process_noise import process_noise
from pliant.controllers.estimation.sensors import Sensor
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.plants.core.argument_gates import require_count
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.lti import LinearModel

from .box_models import corners
from .lqg_over_box import Valued, loops_over
from .many_model_lqr import box_of, delays_of

Array = np.ndarray
FIRST = ((1.0, 1e-2), (1e-2, 1e-4), (1e-2, 1e-3), (1e-4, 1e-4))  # shares of actuators' and of parameters' noise
SPAN = 2.0  # of the first simplex, in powers of e
ITERATIONS = 150
FARTHEST = 20.0  # powers of e, of shares
DEAREST = 7.0  # of the price of inputs: beyond, laws hardly act, and the search for one takes ever longer


@dataclass(frozen=True, eq=False)
class RobustLQG(OwnsArrays):
    """What `robust_lqg` returns."""

    law: LQG
    cost: float  # mean over the corners, linear
    radius: float  # largest |z| there
    actuators: float  # share of their noise
    parameters: Mapping[str, float]  # shares of what each pushes
    effort: float  # times what the scene charges for its inputs


def robust_lqg(
    scene: CostedScene,
    *,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    delays: Sequence[int] = (0, 1),
    sensors: Sequence[Sensor] | None = None,
    iterations: int = ITERATIONS,
) -> RobustLQG:
    """About the goal of a scene, from its sensors or the given ones.

    ranges: smallest and largest factor by name of parameter; +-30 % of what the plant calls uncertain where None.
    delays [periods] of the inputs: those that may be; the law is LQR's for their range, the filter told their middle.
    iterations: of the search. PliantError where none was found that is stable at all corners.

    Guarantee   stable in the linear model about the goal at the corners, the middle and the given delays, which was
                computed there (`radius`), and on its own model. None between the corners, under limits, or for the
                nonlinear plant.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> robust_lqg(scenes.get("single-link-slew"), ranges={"link.E": (0.8, 1.2)}, delays=(0,), iterations=3).radius < 1
    True
    """
    require_scene("robust_lqg", scene)
    box, late = box_of(scene, ranges, "robust_lqg.ranges"), delays_of(delays, "robust_lqg.delays")
    iterations = require_count("robust_lqg", "iterations", iterations, 1, 100_000)
    about, drift = goal_model(scene)
    plain = Kalman.for_scene(scene, sensors=sensors)
    if drift.any() or about.state_names != plain.model.state_names:
        raise PliantError("robust_lqg: the goal is no point of all states, where its models would be told apart")
    loops = loops_over(scene, plain.sensors, _models(scene, box), late)
    assert isinstance(plain.model, LinearModel)
    roots = pushed(scene, plain.model, box, LQR.for_scene(scene).K)
    known: dict[float, LQR] = {}

    def made(theta: Array) -> LQG:
        effort = float(np.exp(theta[-1]))
        if effort not in known:
            known.clear()
            known[effort] = LQR.for_scene(
                scene, effort=effort, delay=late[0] if len(late) == 1 else (late[0], late[-1])
            )
        return LQG(known[effort], _filter(scene, plain, roots, np.exp(theta[:-1]), float(np.mean((late[0], late[-1])))))

    def value(theta: Array) -> float:
        if np.abs(theta).max() > FARTHEST or abs(theta[-1]) > DEAREST:
            return np.inf
        try:
            return loops.value(made(theta)).score
        except PliantError:
            return np.inf

    count = len(box)
    starts = [np.log(np.array([a, *[r] * count, 1.0])) for a, r in FIRST]
    begin = min(starts, key=value)
    simplex = np.vstack([begin, begin + SPAN * np.eye(len(begin))])
    options: dict[str, Any] = {"maxfev": iterations, "initial_simplex": simplex, "adaptive": True}
    theta = minimize(value, begin, method="Nelder-Mead", options=options).x
    law = made(theta)
    best: Valued = loops.value(law)
    if not best.radius < 1:
        raise PliantError(
            f"robust_lqg: none was found that is stable at all corners (largest |z| {best.radius:.4f}): narrow ranges, "
            f"or delays {late}"
        )
    shares = np.exp(theta)
    told = dict(zip(box, shares[1:-1].tolist()))
    return RobustLQG(law, best.cost, best.radius, float(shares[0]), told, float(shares[-1]))


def _models(scene: CostedScene, box: Mapping[str, tuple[float, float]]) -> list[LinearModel]:
    """About the goal, with the parameters of the corners and the middle."""
    varied = scene.plant.vary(*box)
    nominal = varied.nominal_parameters
    return [varied.feedback_model(*scene.target, p=nominal * factors) for factors in corners(box)]


def _filter(scene: CostedScene, plain: Kalman, roots: Sequence[Array], shares: Array, late: float) -> Kalman:
    """With shares (1 + np,) of the noise of actuators and parameters."""
    W = {name: shares[0] * density for name, density in process_noise(scene).items()}
    scaled = [np.sqrt(share) * one for share, one in zip(shares[1:], roots, strict=True)]
    return told_parameters(replace(plain, input_delay=late), plain.sensors, scaled, W, "white", scene.dt)

"""What each weighted signal and each priced input adds to the cost of a control period."""

from __future__ import annotations

from functools import partial

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.plants.native.batch_kernels import random_points

from .control_period import reference
from .row_kernels import Rows

Array = np.ndarray


def term_names(scene: Scene) -> tuple[str, ...]:
    """The weighted signals, then the priced inputs."""
    return (*scene.weighted, *(name for name, _ in scene.effort))


@once_per_scene
def cost_terms(scene: Scene) -> Rows:
    """(x, u, ref, w, p), rows of lanes, -> dt weight (deviation)^2 of each of `term_names`, (n, terms).

    Their sum is what the control kernel charges for a period that starts there.
    """
    plant = scene.varied_plant
    _, x, u, w, p = plant.symbols
    n = len(scene.observe)
    ref = ca.SX.sym("ref", len(reference(scene)))
    output = ca.Function("output", list(plant.symbols), [plant.expressions[1]])
    signals = ca.vertcat(x, output(0.0, x, u, w, p))
    now = [signals[i] for i in scene.positions(scene.weighted)] + [u[i] for i in scene.priced_inputs]
    priced = zip((*scene.weights, *scene.effort), now)
    terms = ca.vertcat(ca.SX(0, 1), *(scene.dt * c * (z - ref[n + k]) ** 2 for k, ((_, c), z) in enumerate(priced)))
    return Rows(ca.Function("terms", [x, u, ref, w, p], ca.cse([ca.densify(terms)])), partial(_points, scene))


def _points(scene: Scene, rng: np.random.Generator) -> list[Array]:
    _, x, u, w, p = random_points(scene.varied_plant, rng)
    return [x, u, np.tile(reference(scene)[:, None], x.shape[1]), w, p]

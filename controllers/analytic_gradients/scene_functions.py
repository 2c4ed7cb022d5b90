"""What a rollout needs of a scene, as functions of a batch: observations, cost of a control period, and their slopes.

The cost is the scene's, dt times `Scene.stage_cost`. Where the scene bounds signals, being near a bound costs as well:
the end of an episode beyond it has no slope,

    PENALTY r max(0, |s| / bound - KNEE)^2 dt,    r the scene's cost rate at the start.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from pliant.plants import Plant
from pliant.plants.core.casadi_functions import NumericFunction, function

Array = np.ndarray
PENALTY, KNEE = 300.0, 0.95


class SceneFunctions:
    """Functions of the scene's varied plant over rows of states x, inputs u and parameters p."""

    def __init__(self, scene: Any) -> None:
        plant: Plant = scene.varied_plant
        self.plant = plant
        t, x, u, w, p = plant.symbols
        output = ca.Function("output", [t, x, u, w, p], [plant.expressions[1]])
        signals = ca.vertcat(x, output(0.0, x, u, np.zeros(plant.nw), p))
        observed = signals[scene.positions(scene.observe)] - scene.goal_values(scene.observe)
        weighed, priced = scene.cost_origin
        errors = signals[scene.positions(scene.weighted)] - weighed
        excess = u[scene.priced_inputs] - priced
        cost = scene.dt * ca.SX(scene.cost_rate(ca.vertsplit(errors), ca.vertsplit(excess)))
        x0, u0 = scene.initial
        rate = float(scene.stage_cost(x0, u0, scene.plant.measure(x0, u0))) or scene.early_end_rate
        near = ca.SX(0.0)
        for name, bound in scene.bounds:
            size = ca.fabs(signals[scene.positions([name])]) / bound
            near += scene.dt * PENALTY * rate * ca.fmax(0.0, size - KNEE) ** 2
        seen = [observed, ca.jacobian(observed, x), ca.jacobian(observed, u)]
        paid = [ca.gradient(cost + near, x), ca.gradient(cost + near, u), cost, near]
        self._observe: NumericFunction = function("observe", [x, u, p], [observed])
        self._observed: NumericFunction = function("observed", [x, u, p], seen[1:], matrices=True)
        self._paid: NumericFunction = function("paid", [x, u, p], paid, matrices=True)

    def observe(self, x: Array, u: Array, p: Array) -> Array:
        """Observations (n, no) less their values at the goal, at x (n, nx), with the input u (n, nu) that acts."""
        return self._observe(x, u, p, batch=len(x))[0]

    def observation_slopes(self, x: Array, u: Array, p: Array) -> tuple[Array, Array]:
        """d(observations)/dx (n, no, nx) and /du (n, no, nu)."""
        C, D = self._observed(x, u, p, batch=len(x))
        return C, D

    def cost_slopes(self, x: Array, u: Array, p: Array) -> tuple[Array, Array, Array, Array]:
        """(d/dx (n, nx), d/du (n, nu)) of what a control period costs, nearness to bounds counted; the scene's cost
        (n,), and what nearness adds (n,).
        """
        lx, lu, cost, near = self._paid(x, u, p, batch=len(x))
        return lx[:, :, 0], lu[:, :, 0], cost[:, 0, 0], near[:, 0, 0]

"""Weights of an MPC tuned by exact gradients of its closed loop's cost, over machines drawn from a box.

The scene's cost J of a run of the nonlinear plant under the law with weights w = w_0 e^theta:

    dx+/dtheta = (dF/dx + dF/du du/dx) dx/dtheta + dF/du du/dtheta,    dJ/dtheta = sum of cost slopes along it

with dF of the native step, du of the quadratic program (`law_derivative`). Adam takes the mean over the machines; what
is kept is the best of all steps. A change of the active set within a run has no slope and is stepped over.

The scene's weights make the law that is best for its linear model without limits; over +-30 % and with limits another
choice costs less. Machines that were not drawn are not known to gain: ask `monte_carlo`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pliant.controllers.analytic_gradients.adam import Adam
from pliant.controllers.analytic_gradients.scene_functions import SceneFunctions
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.mpc.mpc import MPC
from pliant.controllers.robust_design.many_model_lqr import box_of
from pliant.plants.core.argument_gates import require_count, require_function, require_number
from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.integration.step_sensitivities import StepSensitivities

from .law_derivative import DifferentiableMPC

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class TunedMPC(OwnsArrays):
    """What `tune_mpc` returns."""

    law: MPC
    weights: Mapping[str, float]  # by name of signal or input
    costs: Array  # (steps + 1,) mean over the machines, before each step and after the last
    machines: Array  # (runs, np) factors of the parameters

    @property
    def gain(self) -> float:
        """The tuned law's mean cost over that of the scene's weights, dimensionless."""
        return float(self.costs.min() / self.costs[0])


def tune_mpc(
    scene: CostedScene,
    *,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    runs: int = 8,
    steps: int = 20,
    rate: float = 0.1,
    horizon: int = 20,
    seed: int = 0,
    progress: Callable[[float, str], None] | None = None,
) -> TunedMPC:
    """About the goal of a scene, from its weights on, for its cost.

    ranges: smallest and largest factor by name of parameter; +-30 % of what the plant calls uncertain where None. runs:
    machines, drawn by `seed`; steps of Adam with `rate`, of the weights' logarithms; horizon [periods] of the law.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> tune_mpc(scenes.get("single-link-slew"), runs=2, steps=2).gain <= 1
    True
    """
    require_scene("tune_mpc", scene)
    box = box_of(scene, ranges, "tune_mpc.ranges")
    counts = {"runs": runs, "steps": steps, "horizon": horizon}
    runs, steps, horizon = (require_count("tune_mpc", name, value, 1, 10_000) for name, value in counts.items())
    rate, seed = (
        require_number("tune_mpc.rate", rate, "positive"),
        require_count("tune_mpc", "seed", seed, 0, 2**32 - 1),
    )
    told = require_function("tune_mpc.progress", progress) if progress is not None else lambda *_: None
    ends = np.array(list(box.values())).reshape(-1, 2)
    machines = np.random.default_rng([seed, 31]).uniform(ends[:, 0], ends[:, 1], (runs, len(ends)))
    loop = ClosedLoop(scene, machines, tuple(box))
    first = DifferentiableMPC.for_scene(scene, horizon)
    start = {name: value for name, value in {**first.Q, **first.R}.items() if value}
    adam = Adam.start(np.zeros(len(start)))
    costs, best = [], (np.inf, first, start)
    for k in range(steps + 1):
        told(k / (steps + 1), f"step {k}")
        weights = dict(zip(start, (np.array(list(start.values())) * np.exp(adam.theta)).tolist()))
        law = first.with_weights(weights)
        cost, slopes = loop.cost(law)
        costs.append(cost)
        if cost < best[0]:
            best = cost, law, weights
        kept = [law.names.index(name) for name in start]
        adam.step(cost, slopes[kept] * np.array(list(weights.values())), rate)
    return TunedMPC(best[1].law, best[2], np.array(costs), machines)


class ClosedLoop:
    """Runs of a scene under a DifferentiableMPC, one a machine, from the scene's start."""

    def __init__(self, scene: Any, machines: Array, names: tuple[str, ...]) -> None:
        """machines (runs, np): factors of the parameters `names`."""
        played = replace(scene, randomise=tuple((name, 1.0, 1.0) for name in names))
        self.scene, self.plant = scene, played.varied_plant
        self.p = self.plant.nominal_parameters * machines
        self._step = StepSensitivities(self.plant, scene.dt, substeps=scene.substeps, batch=len(machines))
        self._paid = SceneFunctions(played)

    def cost(self, law: DifferentiableMPC) -> tuple[float, Array]:
        """Mean cost, nearness to the scene's bounds counted, and its slope by each weight (nw,). IntegrationError where
        a run diverges, PliantError where the law has no slope."""
        runs, nx, nw = len(self.p), self.plant.nx, len(law.names)
        x, X = np.tile(self.scene.initial[0], (runs, 1)), np.zeros((runs, nx, nw))
        total, slope = 0.0, np.zeros(nw)
        for k in range(self.scene.steps):
            found = [law.derivative(one) for one in x]
            u, Ux, Uw = (np.stack([getattr(one, name) for one in found]) for name in ("u", "state", "weights"))
            U = Ux @ X + Uw
            lx, lu, cost, near = self._paid.cost_slopes(x, u, self.p)
            total += float((cost + near).mean())
            slope += (np.einsum("bi,biw->bw", lx, X) + np.einsum("bi,biw->bw", lu, U)).mean(axis=0)
            after, Fx, Fu = self._step(x, u, p=self.p)
            if not np.isfinite(after).all():
                raise IntegrationError("tune_mpc: a run diverges under the law", k * self.scene.dt, x[0], self.scene.dt)
            x, X = after.copy(), Fx @ X + Fu @ U
        return total, slope

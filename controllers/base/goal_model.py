"""The linear model about a scene's goal in what a law can read and has to hold.

A goal may move steadily: the model is then that of deviations from the moving goal. States that nothing depends on and
that no cost sees, like the angle of a hub that only has to reach a speed, are left out.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pliant.plants.core.errors import EquilibriumError
from pliant.plants.core.signals import names
from pliant.plants.linear.conserved import conserved, free
from pliant.plants.linear.quadratic_cost import about_moving_goal, goal_drift, quadratic_cost

if TYPE_CHECKING:
    from pliant.plants.linear.lti import LinearModel

    from .scene_protocol import CostedScene

HELD = 1e-4  # largest rate of a goal that counts as an equilibrium, in the states' units per second


def require_held(model: LinearModel) -> None:
    """EquilibriumError where the model's point is no equilibrium."""
    moves = np.abs(model.f0)
    if moves.max(initial=0.0) > HELD:
        worst = model.states[int(np.argmax(moves))]
        raise EquilibriumError(
            f"the model's point is no equilibrium: {worst.name} changes by {moves.max():.3g} {worst.unit}/s there; "
            "linearise at one, or follow a nominal with TVLQR",
            float(moves.max()),
        )


def unmoved(scene: CostedScene) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """In words what no input changes about a scene's goal, and what inputs change but neither plant nor cost feels."""
    model = scene.plant.feedback_model(*scene.target)
    cost = quadratic_cost(model, dict(scene.weights), {})
    return conserved(model).names, free(model, np.vstack([cost.Q, cost.N.T]))


def goal_model(scene: CostedScene) -> tuple[LinearModel, np.ndarray]:
    """The model (nx states) and d(goal)/dt (nx,). EquilibriumError where a state that is left in does not stay."""
    model, rates = scene.plant.feedback_model(*scene.target), dict(scene.goal_rates)
    drift, model = goal_drift(model, rates), about_moving_goal(model, rates)
    weighted = dict(scene.weights)
    seen = np.array([name in weighted for name in model.state_names])
    rows = [i for i, s in enumerate(model.outputs) if s.name in weighted and s.name not in model.state_names]
    seen |= (model.C[rows] != 0.0).any(axis=0)
    kept = np.flatnonzero(seen | (model.A != 0.0).any(axis=0))
    moves = np.abs(model.f0)[kept]
    if len(kept) and moves.max() > HELD:
        worst = model.states[kept[int(np.argmax(moves))]]
        raise EquilibriumError(
            f"the goal of scene {scene.name!r} is no equilibrium: {worst.name} changes by {moves.max():.3g} "
            f"{worst.unit}/s there; name the goal's motion in goal_rates, follow a nominal, or give PeriodicLQR "
            "the cycle that it runs in",
            float(moves.max()),
        )
    made = replace(
        model,
        A=model.A[np.ix_(kept, kept)],
        B=model.B[kept],
        E=model.E[kept],
        C=model.C[:, kept],
        states=tuple(model.states[i] for i in kept),
        x0=model.x0[kept],
        f0=model.f0[kept],
    )
    return made, drift[kept]


def away(scene: CostedScene, model: LinearModel) -> np.ndarray:
    """The start less the goal (nx,), in the model's states; what the scene's plant does not have is zero."""
    plant = scene.plant
    values = [np.concatenate([x, plant.measure(x, u)]) for x, u in (scene.initial, scene.target)]
    told = dict(zip(names(plant.states + plant.outputs), values[0] - values[1]))
    return np.array([told.get(name, 0.0) for name in model.state_names])

"""Where a linear model was made, in words: at rest, or what remains of the rates there."""

from __future__ import annotations

import numpy as np

from pliant.plants import LinearModel, Plant
from pliant.plants.core.signals import per_second

ROUNDED = 1e-12  # of the largest input, and of the rates that states cause and that cancel: less is rounding
REST = 1e-8  # of the rates that the point's own states and inputs can cause


def residual(model: LinearModel) -> str:
    """The rates that remain at the model's point, largest first, like "d(crank_angle)/dt = 15.1 rad/s"; "" at rest."""
    own = np.maximum(np.abs(np.concatenate([model.x0, model.u0])), 1e-3)
    scale = np.maximum(np.abs(np.hstack([model.A, model.B])) @ own, 1e-3)
    left = np.flatnonzero(np.abs(model.f0) > REST * scale)
    order = left[np.argsort(-np.abs(model.f0[left]))]
    return ", ".join(
        f"d({model.states[i].name})/dt = {model.f0[i]:.3g} {per_second(model.states[i].unit)}" for i in order
    )


def coordinates(plant: Plant) -> tuple[str, ...]:
    """The states whose rates are states too: not a quaternion."""
    return tuple(plant.rates)


def words(model: LinearModel, plant: Plant) -> str:
    """Like "at rest with tau1 = 3.2 N m", or that it moves on steadily, or is no equilibrium and what remains there."""
    felt, cancelled = np.abs(model.B * model.u0).max(axis=0, initial=0.0), np.abs(model.A * model.x0).max(initial=0.0)
    told = np.abs(model.u0) > ROUNDED * np.abs(model.u0).max(initial=0.0)
    u = np.where(told & (felt > ROUNDED * cancelled), model.u0, 0.0)
    inputs = ", ".join(f"{s.name} = {v:.4g} {s.unit}" for s, v in zip(model.inputs, u))
    left = residual(model)
    spins = any(s.name in plant.velocities and abs(x) > REST for s, x in zip(model.states, model.x0))
    steady = "in steady motion" if spins else "at rest"
    state = f"at a point that is no equilibrium ({left} there)" if left else steady
    return f"{state} with {inputs}" if inputs else state

"""The quadratic cost of a linear model from weights by name, and the model of deviations from a goal that moves.

    sum_i weight_i (C_i x + D_i u)^2 + sum_j effort_j u_j^2 = x'Q x + u'R u + 2 x'N u,    x, u deviations from the point
    Q = C'W C,  R = D'W D + diag(effort),  N = C'W D,    W = diag(weights)

It stands among the plants because scenes (pliant.envs) and controllers both need it and never import each other: it is
the only place where weights become matrices. To second order it is the cost of the plant itself where the weighed
signals are at their goal at the model's point.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.signals import index, rows_by_name

from .lti import LinearModel

Array = np.ndarray


class QuadraticCost(NamedTuple):
    """x'Q x + u'R u + 2 x'N u."""

    Q: Array  # (nx, nx) >= 0
    R: Array  # (nu, nu)
    N: Array  # (nx, nu), not zero where a weighed output depends on the input at once


def quadratic_cost(
    model: LinearModel,
    weights: Mapping[str, float],
    effort: Mapping[str, float],
    *,
    weighed: str = "weighted signal",
    priced: str = "input",
) -> QuadraticCost:
    """Weights by name of state or output, effort by name of input; what is not named costs nothing.

    `weighed`, `priced`: what ValueError calls a name that the model does not have.
    """
    C, D, _ = signal_rows(model, weights, weighed)
    own = np.zeros(len(model.inputs))
    for name, value in effort.items():
        own[index(model.inputs, name, priced)] = value
    return squares(C, D, weights.values(), own)


def squares(C: Array, D: Array, weights: Iterable[float], effort: Array) -> QuadraticCost:
    """Of signals C x + D u, C (m, nx), D (m, nu), with their weights (m), and inputs with their effort (nu,)."""
    scaled = np.array([float(value) for value in weights])[:, None]
    return QuadraticCost(C.T @ (scaled * C), D.T @ (scaled * D) + np.diag(effort), C.T @ (scaled * D))


def signal_rows(model: LinearModel, wanted: Iterable[str], kind: str) -> tuple[Array, Array, Array]:
    """C (n, nx), D (n, nu) and values at the model's point (n,) of states or outputs C x + D u by name."""
    at, C, D, _ = rows_by_name(model, wanted, kind)
    return C, D, np.concatenate([model.x0, model.y0])[at]


def goal_drift(model: LinearModel, rates: Mapping[str, float]) -> Array:
    """d(goal)/dt (nx,) of the model's states from rates by name; those of others do not count."""
    return np.array([float(rates.get(signal.name, 0.0)) for signal in model.states])


def about_moving_goal(model: LinearModel, rates: Mapping[str, float]) -> LinearModel:
    """The model of deviations from a goal that moves at `rates`: f0 less what the goal itself moves at."""
    drift = goal_drift(model, rates)
    return replace(model, f0=model.f0 - drift) if drift.any() else model


def following(plant: PlantLike, x: Array, u: Array, drift: Array) -> frozenset[str]:
    """Outputs that a goal x (nx,), u (nu,) moves as its states move at `drift` (nx,): seen at three places on its way.

    Of these a cost has no steady goal: an output bends where its states move evenly.
    """
    if not drift.any():
        return frozenset()
    ways = [x + s * drift / np.abs(drift).max() for s in (0.0, 0.7, -1.1)]
    C = np.array([plant.jacobians(way, u)[3] for way in ways])
    rounding = 1e-12 * np.abs(C).max((0, 2)) * np.abs(drift).max()
    moved = (np.abs(C @ drift) > rounding).any(axis=0)
    states = {s.name for s in plant.states}
    return frozenset(s.name for s, m in zip(plant.outputs, moved, strict=True) if m and s.name not in states)


def require_still(owner: str, moved: frozenset[str], names: Iterable[str]) -> None:
    """ValueError where a cost or an observation names an output that `goal_rates` move."""
    if taken := sorted(moved.intersection(names)):
        raise ValueError(
            f"{owner}: goal_rates move {', '.join(taken)} too, whose goal would stay; weigh and observe the states "
            "that move, or outputs that these leave where they are"
        )

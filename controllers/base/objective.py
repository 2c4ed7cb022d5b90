"""What a motion is charged and what it may not do: shared by planning, predictive control and the bound.

J = sum over control periods of dt |r(x, u)|^2, r = [sqrt(weight_i) (z_i - z_i,goal); sqrt(effort_j) (u_j - u_j,goal)],
z any states or outputs by name. Since J is a sum of squares, 2 r'r has the Gauss-Newton Hessian 2 (dr/dz)'(dr/dz),
which is exact where z is linear in x and u.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import (
    require_by_name,
    require_finite,
    require_instance,
    require_mapping,
    require_number,
    require_seconds,
)
from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.signals import OwnsArrays, index, names, sealed
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.quadratic_cost import QuadraticCost, following, require_still, squares

from .controller import ends, saturation
from .scene_protocol import require_scene

if TYPE_CHECKING:
    from .scene_protocol import CostedScene


@dataclass(frozen=True, eq=False, kw_only=True)
class Objective(OwnsArrays):
    """A goal (x, u), weights by name of state or output, efforts by name of input, limits and bounds."""

    plant: Plant
    x_goal: np.ndarray  # (nx,)
    u_goal: np.ndarray  # (nu,)
    weights: Mapping[str, float]  # of the squared deviation of a state or output from its value at the goal
    effort: Mapping[str, float]  # of the squared deviation of an input
    dt: float  # [s] control period
    limits: Any = None  # of the inputs: a pair (lowest, highest), or {input: (lowest, highest)}
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)  # lowest, highest of a state or output
    goal_rates: Mapping[str, float] = field(default_factory=dict)  # d/dt of states of a goal that moves, from t = 0 on

    def __post_init__(self) -> None:
        plant, owner = require_instance("Objective.plant", self.plant, Plant), "Objective"
        values: dict[str, Any] = {"dt": require_seconds(f"{owner}.dt", self.dt)}
        for name, size in (("x_goal", plant.nx), ("u_goal", plant.nu)):
            values[name] = require_finite(f"{owner}.{name}", getattr(self, name), (size,)).copy()
        states, known, inputs = names(plant.states), names(self.signals), names(plant.inputs)
        for name, own, kind, allowed in (
            ("weights", known, "state or output", "nonnegative"),
            ("effort", inputs, "input", "positive"),
            ("goal_rates", states, "state", "finite"),
        ):
            values[name] = require_by_name(f"{owner}.{name}", getattr(self, name), own, kind, allowed)
        bounds = require_mapping(f"{owner}.bounds", self.bounds, known, "state or output")
        values["bounds"] = {name: ends(f"{owner}.bounds[{name!r}]", pair) for name, pair in bounds.items()}
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if not self.weights and not self.effort:
            raise ValueError(f"{owner}.weights, effort are empty, must name at least one signal")
        object.__setattr__(self, "limits", saturation(owner, self.limits, inputs))

    @classmethod
    def of(cls, scene: CostedScene) -> Self:
        """The cost, limits and bounds of a scene (pliant.envs.Scene) about its goal."""
        require_scene("Objective.of", scene)
        high = np.array(scene.limits, dtype=float)
        x, u = scene.target
        return cls(
            plant=scene.plant,
            x_goal=x,
            u_goal=u,
            weights=dict(scene.weights),
            effort=dict(scene.effort),
            dt=scene.dt,
            limits=(-high, high),
            bounds={name: (-value, value) for name, value in scene.bounds},
            goal_rates=dict(scene.goal_rates),
        )

    @cached_property
    def drift(self) -> np.ndarray:
        """d/dt of the goal (nx,)."""
        return np.array([float(self.goal_rates.get(s.name, 0.0)) for s in self.plant.states])

    def goal_at(self, t: float) -> np.ndarray:
        """The goal (nx,) at t [s]."""
        return self.x_goal + require_number("Objective.goal_at: t", t, unit="s") * self.drift

    @property
    def signals(self) -> tuple[Any, ...]:
        """What weights and bounds may name."""
        return self.plant.states + self.plant.outputs

    @cached_property
    def residual_expression(self) -> ca.SX:
        """r (nr,) in the plant's symbols (t, x, u, w, p)."""
        t, x, u, _, _ = self.plant.symbols
        require_still("Objective", following(self.plant, self.x_goal, self.u_goal, self.drift), self.weights)
        z0 = np.concatenate([self.x_goal, self.plant.measure(self.x_goal, self.u_goal)])
        drift = np.array([self.goal_rates.get(s.name, 0.0) for s in self.signals])
        z = ca.vertcat(x, self.plant.expressions[1])
        places = [index(self.signals, name, "signal") for name in self.weights]
        rows = [np.sqrt(weight) * (z[i] - z0[i] - drift[i] * t) for i, weight in zip(places, self.weights.values())]
        inputs = [index(self.plant.inputs, name, "input") for name in self.effort]
        rows += [np.sqrt(value) * (u[j] - self.u_goal[j]) for j, value in zip(inputs, self.effort.values())]
        return ca.vertcat(*rows)

    @cached_property
    def bounded_expression(self) -> tuple[ca.SX, np.ndarray, np.ndarray]:
        """(z (nb,), lowest, highest) of the bounded signals in the plant's symbols."""
        z = ca.vertcat(self.plant.symbols[1], self.plant.expressions[1])
        places = [index(self.signals, name, "signal") for name in self.bounds]
        low, high = (np.array([pair[k] for pair in self.bounds.values()], dtype=float) for k in (0, 1))
        return ca.vertcat(*[z[i] for i in places]), low, high

    @cached_property
    def _residual(self) -> NumericFunction:
        return function("residual", list(self.plant.symbols), [self.residual_expression])

    def rate(self, x: Any, u: Any, t: Any = 0.0) -> Any:
        """Cost rate r'r [1/s] at x (nx,) or (B, nx), u (nu,) or (B, nu), t [s] or (B,)."""
        values, batch = self.plant._arguments(x, u, t=t)
        r = self._residual(*values, batch=batch)[0]
        return (r**2).sum(axis=-1)

    def cost(self, x: Any, u: Any, t0: float = 0.0) -> float:
        """J of states x (N+1, nx) or (N, nx) and the inputs u (N, nu) held from each to the next, from t0 [s] on.

        ValueError where the rows do not fit.
        """
        u = require_finite("Objective.cost: u", u, (-1, self.plant.nu))
        x = require_finite("Objective.cost: x", x, (-1, self.plant.nx))
        if len(x) not in (len(u), len(u) + 1):
            raise ValueError(f"Objective.cost: x has {len(x)} rows, must have as many as u, {len(u)}, or one more")
        t = require_number("Objective.cost: t0", t0, unit="s") + self.dt * np.arange(len(u))
        return float(self.dt * self.rate(x[: len(u)], u, t).sum())

    def quadratic(self) -> QuadraticCost:
        """Q (nx, nx), R (nu, nu), N (nx, nu): the cost rate x'Qx + u'Ru + 2 x'Nu of deviations from the goal."""
        plant = self.plant
        slopes = plant.jacobians(self.x_goal, self.u_goal)
        C, D = np.vstack([np.eye(plant.nx), slopes[3]]), np.vstack([np.zeros((plant.nx, plant.nu)), slopes[4]])
        at = [index(self.signals, name, "signal") for name in self.weights]
        effort = np.array([float(self.effort.get(s.name, 0.0)) for s in plant.inputs])
        return squares(C[at], D[at], self.weights.values(), effort)

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: sealed(getattr(self, f.name)) for f in fields(self)}  # expressions are made again

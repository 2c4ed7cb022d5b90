"""The nonlinear program of a multiple-shooting problem: values and sparse derivatives, stage by stage.

Variables z = [u_0, x_1, u_1, .., x_N]; x_0 is given. Constraints: of each stage x_{k+1} - F(x_k, u_k), then its bounded
outputs; of the end its bounded outputs that no input enters, then x_N - x_goal where the motion must end there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import casadi as ca
import numpy as np

from pliant.controllers.solvers.block_sparsity import Pattern, places
from pliant.plants.core.argument_gates import require_by_name, require_choice, require_count, require_finite, shown
from pliant.plants.core.signals import index

from .shooting_derivatives import HeldSteps
from .stage_derivatives import StageTerms

if TYPE_CHECKING:
    from pliant.controllers.base.objective import Objective

Array = np.ndarray
T = TypeVar("T")


class Transcription:
    """The program of `optimal`."""

    def __init__(
        self,
        objective: Objective,
        x0: Array,
        N: int,
        substeps: int,
        P: Array | None,
        at_goal: bool,
        w: Array,
        p: Array,
        *,
        exact: bool,
        at: Mapping[int, Mapping[str, float]] | None = None,
        reference: Mapping[str, Any] | None = None,
    ) -> None:
        plant = self.plant = objective.plant
        self.objective, self.x0, self.N, self.P, self.exact, self.at_goal = objective, x0, N, P, exact, at_goal
        self.nx, self.nu, self.nz = plant.nx, plant.nu, plant.nx + plant.nu
        self.t, self._given = objective.dt * np.arange(N + 1), (w, p)
        self.goal = objective.goal_at(self.t[-1])
        self.periods = HeldSteps(plant, objective.dt, substeps, self.t[:-1], w, p)
        self.charge = StageTerms(objective, objective.residual_expression)
        self._shift = _shift(objective, reference or {}, N)
        self._at = _checked_at(at, N, [s.name for s in objective.signals])
        states = {s.name: i for i, s in enumerate(plant.states)}
        self._state_bounds = [(states[n], low, high) for n, (low, high) in objective.bounds.items() if n in states]
        wanted = {n: pair for n, pair in objective.bounds.items() if n not in states}
        for name in dict.fromkeys(n for values in self._at.values() for n in values):
            wanted.setdefault(name, (-np.inf, np.inf))
        self._output_names, signals = list(wanted), ca.vertcat(plant.symbols[1], plant.expressions[1])
        outputs = ca.vertcat(*[signals[index(objective.signals, n, "optimal: state or output")] for n in wanted])
        self.outputs = StageTerms(objective, outputs)
        self._low, self._high = (np.array([pair[i] for pair in wanted.values()], dtype=float) for i in (0, 1))
        entered = np.array(ca.DM(ca.jacobian(outputs, plant.symbols[2]).sparsity(), 1)).reshape(len(wanted), plant.nu)
        self._last_rows = np.flatnonzero(~entered.any(axis=1))
        known_at_end = [self._output_names[i] for i in self._last_rows]
        for name in self._at.get(N, {}):
            if name not in known_at_end:
                raise ValueError(f"optimal.at[{N}]: {name} depends on the input, which ends before")
        self._memo: dict[str, tuple[bytes, Any]] = {}
        self._sizes()

    def _sizes(self) -> None:
        N, nx, nz, nb, end = self.N, self.nx, self.nz, len(self._low), len(self._last_rows)
        self.stage_rows, self.size = nx + nb, N * nz
        self.rows = N * self.stage_rows + end + (nx if self.at_goal else 0)
        first, last = N * self.stage_rows, N * nz - nx
        k, i, j = places(N, nx + nb, nz)
        row, column = [k * self.stage_rows + i], [k * nz + j - nx]
        k, i, _ = places(N, nx, 1)
        row, column = [*row, k * self.stage_rows + i], [*column, (k + 1) * nz + i - nx]
        _, i, j = places(1, end, nx)
        row, column = [*row, first + i], [*column, last + j]
        if self.at_goal:
            row, column = [*row, first + end + np.arange(nx)], [*column, last + np.arange(nx)]
        self.jacobian_pattern = Pattern(self.rows, self.size, row, column)
        k, i, j = places(N, nz, nz)
        row, column = [k * nz + i - nx], [k * nz + j - nx]
        _, i, j = places(1, nx, nx)
        self.hessian_pattern = Pattern(self.size, self.size, [*row, last + i], [*column, last + j], upper=True)

    def pack(self, x: Array, u: Array) -> Array:
        """z from x (N+1, nx) and u (N, nu)."""
        return np.concatenate([np.hstack([x[:-1], u]).ravel()[self.nx :], x[-1]])

    def unpack(self, z: Array) -> tuple[Array, Array]:
        """x (N+1, nx) and u (N, nu)."""
        rows = np.concatenate([self.x0, z, np.zeros(self.nu)]).reshape(self.N + 1, self.nz)
        return rows[:, : self.nx], rows[:-1, self.nx :]

    @property
    def stages(self) -> dict[str, list[int]]:
        """Numbers of states, inputs and bounded rows of every stage, the end included."""
        N, end = self.N, self.rows - self.N * self.stage_rows
        return {
            "nx": [0, *[self.nx] * N],
            "nu": [*[self.nu] * N, 0],
            "ng": [*[self.stage_rows - self.nx] * N, end],
        }

    def variable_bounds(self) -> tuple[Array, Array]:
        """Lowest and highest z: limits of the inputs, bounds of the states."""
        found = []
        for k, limit in enumerate(self.objective.limits):
            x = np.full((self.N + 1, self.nx), (-np.inf, np.inf)[k])
            for bound in self._state_bounds:
                x[:, bound[0]] = bound[1 + k]
            found.append(self.pack(x, np.tile(limit, (self.N, 1))))
        return found[0], found[1]

    def row_bounds(self) -> tuple[Array, Array]:
        """Lowest and highest constraint; outputs at the start that no input enters are given, not bounded."""
        found = []
        for values, free in ((self._low, -np.inf), (self._high, np.inf)):
            rows = np.zeros((self.N + 1, self.stage_rows))
            rows[:, self.nx :] = values
            rows[0, self.nx + self._last_rows] = free
            for k, pinned in self._at.items():
                for name, value in pinned.items():
                    rows[k, self.nx + self._output_names.index(name)] = value
            end = rows[-1, self.nx + self._last_rows]
            found.append(np.concatenate([rows[:-1].ravel(), end, np.zeros(self.nx * self.at_goal)]))
        return found[0], found[1]

    def _kept(self, what: str, z: Array, make: Callable[[Array], T]) -> T:
        """make(z), once for calls in a row at the same z."""
        key = z.tobytes()
        if what not in self._memo or self._memo[what][0] != key:
            self._memo[what] = key, make(z)
        return self._memo[what][1]

    def _charged(self, z: Array) -> list[Array]:
        x, u = self.unpack(z)
        r, J = self.charge.values(self.t[:-1], x[:-1], u, *self._given)
        return [r - self._shift, J]

    def cost(self, z: Array) -> float:
        """The objective of the program."""
        r, _ = self._kept("charge", z, self._charged)
        value = self.objective.dt * float((r**2).sum())
        if self.P is not None:
            error = z[-self.nx :] - self.goal
            value += float(error @ self.P @ error)
        return value

    def gradient(self, z: Array) -> Array:
        """The objective's gradient (size,)."""
        r, J = self._kept("charge", z, self._charged)
        slope = 2 * self.objective.dt * np.einsum("kri,kr->ki", J, r)
        error = z[-self.nx :] - self.goal
        end = np.zeros(self.nx) if self.P is None else (self.P + self.P.T) @ error
        return np.concatenate([slope.ravel()[self.nx :], end])

    def constraints(self, z: Array) -> Array:
        """The constraints (rows,)."""
        x, u = self.unpack(z)
        return self._gather(self.periods.ends(x[:-1], u), x, u)

    def _gather(self, ends: Array, x: Array, u: Array) -> Array:
        limited = self.outputs.values(self.t[:-1], x[:-1], u, *self._given)[0]
        stages = np.hstack([x[1:] - ends, limited])
        goal = x[-1] - self.goal if self.at_goal else np.zeros(0)
        return np.concatenate([stages.ravel(), self._at_end(x[-1])[0][self._last_rows], goal])

    def _at_end(self, x: Array) -> list[Array]:
        return [v[0] for v in self.outputs.values(self.t[-1:], x[None], np.zeros((1, self.nu)), *self._given)]

    def jacobian(self, z: Array) -> tuple[Array, ca.DM]:
        """The constraints and their sparse Jacobian."""
        return self._kept("jacobian", z, self._jacobian)

    def _jacobian(self, z: Array) -> tuple[Array, ca.DM]:
        x, u = self.unpack(z)
        found = self.periods.slopes(x[:-1], u)
        stages = np.concatenate([-found.slope, self.outputs.values(self.t[:-1], x[:-1], u, *self._given)[1]], axis=1)
        parts = [stages.ravel(), np.ones(self.N * self.nx), self._at_end(x[-1])[1][self._last_rows, : self.nx]]
        if self.at_goal:
            parts.append(np.ones(self.nx))
        return self._gather(found.end, x, u), self.jacobian_pattern.fill(parts)

    def worst(self, z: Array) -> str:
        """Which limit, bound or step is violated most, and by how much, in words."""
        x, u = (s for s in (self.plant.states, self.plant.inputs))
        steps = [f"the step of {s.name}" for s in x] + self._output_names
        ends = [self._output_names[i] for i in self._last_rows] + [f"{s.name} at the goal" for s in x]
        found = []
        for values, (low, high), names, first, count in (
            (z, self.variable_bounds(), [s.name for s in x + u], self.nx, self.nz),
            (self.jacobian(z)[0], self.row_bounds(), steps, 0, self.stage_rows),
        ):
            excess = np.maximum(low - values, values - high)
            i = int(np.nanargmax(excess))
            k, place = divmod(i + first, count)
            name = names[place] if k < self.N or first else ends[i - self.N * self.stage_rows]
            found.append((float(excess[i]), name, self.t[k if first or k < self.N else self.N]))
        value, name, time = max(found)
        return f"{name} violated by {value:.2g} at {time:.4g} s" if value > 0 else "no constraint violated"

    def hessian(self, z: Array, scale: float, multipliers: Array) -> ca.DM:
        """The upper triangle of the Hessian of scale * objective + multipliers' constraints."""
        x, u = self.unpack(z)
        at = (self.t[:-1], x[:-1], u, *self._given)
        r, J = self._kept("charge", z, self._charged)
        blocks = 2 * self.objective.dt * scale * (J.transpose(0, 2, 1) @ J)
        first = self.N * self.stage_rows
        end = np.zeros((self.nx, self.nx)) if self.P is None else scale * (self.P + self.P.T)
        if self.exact:
            stages = multipliers[:first].reshape(self.N, self.stage_rows)
            blocks += 2 * self.objective.dt * scale * self.charge.curvature(*at, r)
            blocks += self.periods.slopes(x[:-1], u, keep=True).hessian(-stages[:, : self.nx])
            blocks += self.outputs.curvature(*at, stages[:, self.nx :])
            m = np.zeros((1, len(self._low)))
            m[0, self._last_rows] = multipliers[first : first + len(self._last_rows)]
            last = self.outputs.curvature(self.t[-1:], x[-1:], np.zeros((1, self.nu)), *self._given, m)
            end = end + last[0, : self.nx, : self.nx]
        return self.hessian_pattern.fill([blocks, end])


def _checked_at(at: Any, N: int, known: Sequence[str]) -> dict[int, dict[str, float]]:
    """ValueError unless every step is one of the plan's, every name known and every value finite."""
    if at is None:
        return {}
    if not isinstance(at, Mapping):
        raise ValueError(f"optimal.at = {shown(at)} must be values by name for each step")
    return {
        require_count("optimal", "at step", k, 1, N): require_by_name(f"optimal.at[{k}]", values, known, "signal")
        for k, values in at.items()
    }


def _shift(objective: Objective, reference: Mapping[str, Any], N: int) -> Array:
    """(N, nr) what a moving reference takes from the residual of the goal."""
    goal = np.concatenate([objective.x_goal, objective.plant.measure(objective.x_goal, objective.u_goal)])
    names, shift = list(objective.weights), np.zeros((N, len(objective.weights) + len(objective.effort)))
    for name, values in reference.items():
        require_choice("optimal", "reference", name, names)
        values = require_finite(f"optimal.reference[{name!r}]", values, (N,))
        away = values - goal[index(objective.signals, name, "signal")]
        if name in objective.goal_rates:
            away = away - objective.goal_rates[name] * objective.dt * np.arange(N)
        shift[:, names.index(name)] = np.sqrt(objective.weights[name]) * away
    return shift

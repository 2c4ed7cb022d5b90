"""The first input of a linear MPC and its derivatives: by the state, the reference, and every weight.

Program   min_U J(x - x_s, U; w),  rows_x (x - x_s) + rows_s x_s + rows_U U within their ends
          J = sum over the horizon of the cost of a step, and the cost to go P(w) of the problem without limits
Where no row becomes active or ceases to be, the active ones (A) stay equalities, and
          [H  A'] [dU    ]     [dH U + F d(x - x_s) + dF (x - x_s)]
          [A  0 ] [d mult] = - [A_x d(x - x_s) + A_s d x_s        ]
with H, F the second derivatives of J/2: the implicit function theorem on the Karush-Kuhn-Tucker conditions (Amos and
others 2018, "Differentiable MPC for end-to-end planning and control"). P's derivative by a weight is the solution of
the Lyapunov equation of its Riccati equation, dP = A_c' dP A_c + [1; -K]' dW [1; -K].

At a change of the active set the input has two derivatives: `margin` tells how far it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, Self, final

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from pliant.controllers import riccati
from pliant.controllers.base.controller import reading
from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.mpc.mpc import MPC
from pliant.plants.core.argument_gates import (
    require_by_name,
    require_count,
    require_instance,
    require_seconds,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.quadratic_cost import quadratic_cost

Array = np.ndarray


class LawDerivative(NamedTuple):
    """Of the first input u (nu,), in its unit over that of what it is derived by."""

    u: Array  # (nu,)
    state: Array  # (nu, nx)
    reference: Array  # (nu, nx), of the state that the model's point is moved to, its input held
    weights: Array  # (nu, nw), in the order of `names`
    active: int  # rows at their ends
    margin: float  # least multiplier of those, or room of the others in halves of their ranges: 0 at a change


@final
class DifferentiableMPC:
    """An MPC of all states, with limits of inputs and soft bounds, and the derivatives of its first input."""

    def __init__(
        self,
        model: LinearModel,
        Q: Mapping[str, float],
        R: Mapping[str, float],
        *,
        dt: float,
        horizon: int = 20,
        limits: Any = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        """Continuous model; weights by name as in `MPC.design`, dt [s], horizon [periods], limits, bounds as there."""
        require_instance("DifferentiableMPC.model", model, LinearModel)
        dt, horizon = require_seconds("DifferentiableMPC.dt", dt), require_count("MPC", "horizon", horizon, 1, 1000)
        known = model.state_names + model.output_names
        self.Q = dict(require_by_name("DifferentiableMPC.Q", Q, known, "state or output", "nonnegative"))
        self.R = dict(require_by_name("DifferentiableMPC.R", R, model.input_names, "input", "positive"))
        self.law = MPC.design(model, self.Q, self.R, dt=dt, horizon=horizon, limits=limits, bounds=bounds)
        if any((*self.law.conserved, *self.law.free)):
            raise PliantError("DifferentiableMPC: something is conserved or free: weights do not settle the law alone")
        self.names, self.model, self.dt, self.horizon = (*self.Q, *self.R), model, dt, horizon
        self._made: dict[str, Any] = {"dt": dt, "horizon": horizon, "limits": limits, "bounds": bounds}
        A, B, Qd, Rd, Nd = riccati.sampled(model.A, model.B, *weight_matrices("MPC", model, self.Q, self.R), dt=dt)
        found = riccati.dlqr(A, B, Qd, Rd, Nd, names=model.state_names, dt=dt)
        self._motion = _motion(A, B, horizon)
        self._H, self._F = self._condensed(Qd, Rd, Nd, found.P)
        closed, both = A - B @ found.K, np.vstack([np.eye(len(A)), -found.K])
        slopes = []
        for unit in _units(model, self.Q, self.R):
            dQ, dR, dN = riccati.sampled(model.A, model.B, *unit, dt=dt)[2:]
            right = both.T @ np.block([[dQ, dN], [dN.T, dR]]) @ both
            slopes.append(self._condensed(dQ, dR, dN, solve_discrete_lyapunov(closed.T, (right + right.T) / 2)))
        self._dH, self._dF = (np.stack([one[i] for one in slopes]) for i in (0, 1))
        self._rows()

    @classmethod
    def for_scene(cls, scene: CostedScene, horizon: int = 20) -> Self:
        """About a scene's goal, with its weights, limits and bounds. PliantError where its goal leaves states out.

        Example
        -------
        >>> from pliant.envs import scenes
        >>> scene = scenes.get("single-link-slew")
        >>> DifferentiableMPC.for_scene(scene).derivative(scene.target[0]).state.shape
        (1, 6)
        """
        require_scene("DifferentiableMPC.for_scene", scene)
        model, drift = goal_model(scene)
        if drift.any() or model.state_names != tuple(s.name for s in scene.plant.states):
            raise PliantError("DifferentiableMPC.for_scene: the goal must be a point of all states")
        high = np.array(scene.limits, dtype=float)
        known = model.state_names + model.output_names
        bounds = {name: (-value, value) for name, value in scene.bounds if name in known}
        made: dict[str, Any] = {"dt": scene.dt, "horizon": horizon, "limits": (-high, high), "bounds": bounds}
        return cls(model, dict(scene.weights), dict(scene.effort), **made)

    def with_weights(self, weights: Mapping[str, float]) -> Self:
        """The same with other weights, by name, of those in `names`; each in its own unit."""
        given = require_by_name("DifferentiableMPC.with_weights", weights, self.names, "weight", "positive")
        Q, R = ({name: given.get(name, value) for name, value in own.items()} for own in (self.Q, self.R))
        return type(self)(self.model, Q, R, **self._made)

    def derivative(self, y: Any) -> LawDerivative:
        """At the states y (nx,). PliantError where the program fails, or exceeds a soft bound."""
        y = reading("DifferentiableMPC.y", y, len(self.model.x0))
        self.law.reset()
        u = self.law.act(0.0, y)
        step, record = self.law._steps[0], self.law.record
        if record.failures or (record.limited and step.solver.violated):
            raise PliantError(f"DifferentiableMPC.derivative: no plan from {y} keeps all limits: there is no slope")
        multipliers = step.solver.multipliers if record.limited else np.zeros(len(step.low))
        x, active = y - self.model.x0, np.flatnonzero(multipliers)
        lower, upper = (ends - step.G[: len(step.low)] @ y for ends in (step.low, step.high))
        z = np.zeros(step.solver.M.shape[1])
        if len(active):
            ends = np.where(multipliers > 0, upper, lower)[active]
            z = np.linalg.lstsq(step.solver.M[active], ends, rcond=None)[0]
        U = (step.plan[0] @ y + step.plan[1] @ z + step.plan[2] - self.model.u0).ravel()
        rest = np.setdiff1d(np.arange(len(multipliers)), active)
        room = np.minimum(upper - step.solver.M @ z, step.solver.M @ z - lower)[rest]
        A, n = self._AU[active], len(U)
        whole = np.block([[self._H, A.T], [A, np.zeros((len(A), len(A)))]])
        nx = len(x)
        right = np.zeros((n + len(A), 2 * nx + len(self.names)))
        right[:n, :nx], right[n:, :nx] = self._F, self._Ax[active]
        right[:n, nx : 2 * nx], right[n:, nx : 2 * nx] = -self._F, self._As[active] - self._Ax[active]
        right[:n, 2 * nx :] = (self._dH @ U + self._dF @ x).T
        found = -np.linalg.solve(whole, right)[: len(u)]
        near = min(np.abs(multipliers[active]).min(initial=np.inf), room.min(initial=np.inf))
        return LawDerivative(u, found[:, :nx], found[:, nx : 2 * nx], found[:, 2 * nx :], len(active), float(near))

    def _condensed(self, Q: Array, R: Array, N: Array, P: Array) -> tuple[Array, Array]:
        """H (n nu, n nu), F (n nu, nx) of J/2 = U'H U/2 + U'F x + .."""
        x, n = self._motion, self.horizon
        nx, nu = N.shape
        inputs = np.zeros((n, nu, nx + n * nu))
        for j in range(n):
            inputs[j, :, nx + j * nu : nx + (j + 1) * nu] = np.eye(nu)
        both = np.concatenate([x[:n], inputs], axis=1)
        whole = np.einsum("jia,ik,jkb->ab", both, np.block([[Q, N], [N.T, R]]), both, optimize=True)
        whole = whole + x[n].T @ P @ x[n]
        return whole[nx:, nx:], whole[nx:, :nx]

    def _rows(self) -> None:
        """Rows of the limits in x - x_s, x_s and U, which weights do not change: the law's, in other variables."""
        step = self.law._steps[0]
        n, nx, m = self.horizon * len(self.model.u0), len(self.model.x0), len(step.low)
        to_x, to_z = step.plan[0].reshape(n, nx), step.plan[1].reshape(n, -1)
        self._AU = np.linalg.solve(to_z.T, step.solver.M.T).T
        self._Ax = step.G[:m] - self._AU @ to_x
        limits = self.law.limits
        signals = np.zeros((len(limits.bounded), nx))
        for i, name in enumerate(limits.bounded):
            at = name in self.model.state_names
            C = np.eye(nx) if at else self.model.C
            signals[i] = C[(self.model.state_names if at else self.model.output_names).index(name)]
        soft = step.names >= 0
        self._As = np.zeros((m, nx))
        self._As[soft] = signals[step.names[soft]] / step.scale[soft, None]


def _motion(A: Array, B: Array, n: int) -> Array:
    """(n + 1, nx, nx + n nu): x_j of [x_0; U]."""
    nx, nu = B.shape
    x = np.zeros((n + 1, nx, nx + n * nu))
    x[0, :, :nx] = np.eye(nx)
    for j in range(n):
        x[j + 1] = A @ x[j]
        x[j + 1, :, nx + j * nu : nx + (j + 1) * nu] += B
    return x


def _units(model: LinearModel, Q: Mapping[str, float], R: Mapping[str, float]) -> list[tuple[Array, Array, Array]]:
    """Q, R, N of a unit of each weight."""
    found = []
    for name in Q:
        one = quadratic_cost(model, {name: 1.0}, {})
        found.append((one.Q, one.R, one.N))
    nx, nu = model.B.shape
    for name in R:
        at = model.input_names.index(name)
        found.append((np.zeros((nx, nx)), np.diag(np.eye(nu)[at]), np.zeros((nx, nu))))
    return found

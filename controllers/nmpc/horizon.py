"""A plan over a horizon and the problem about it: x_{k+1} = F(x_k, u_k), cost dt |r(x_k, u_k)|^2, bounded signals.

Nodes x_k are kept apart from what the plant does (multiple shooting), so that every stage is linearised by itself:
all of them are lanes of one native call. The residuals' slopes give the Gauss-Newton Hessian. Full steps of it lose a
plant with hardly damped modes above half the sampling rate, whose gaps grow from step to step; `hold` damps them.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, final

import casadi as ca
import numpy as np

from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.integration.step_sensitivities import StepSensitivities
from pliant.plants.native.batch_kernels import BatchKernel, map_kernel, random_points

from .condensing import Condensed
from .stage_recursion import StageRecursion

if TYPE_CHECKING:
    from pliant.controllers.base.objective import Objective

    from .terminal_cost import MovingEnd, Terminal

Array = np.ndarray
DAMPING = 3.0  # changes besides the regulator's feedback are a quarter as long


@lru_cache(maxsize=16)
def stage_kernel(objective: Objective) -> BatchKernel:
    """(t, x, u, w, p) -> r (nr,), [dr/dx, dr/du] row by row, z (nb,), [dz/dx, dz/du] row by row."""
    _, x, u, _, _ = objective.plant.symbols
    parts = []
    for e in (objective.residual_expression, objective.bounded_expression[0]):
        parts += [ca.densify(e), ca.densify(ca.jacobian(e, ca.vertcat(x, u)).T)]
    function = ca.Function("stage", list(objective.plant.symbols), ca.cse(parts))
    return map_kernel(function, random_points(objective.plant, np.random.default_rng(0)))


@final
class Horizon:
    """The plan x (N+1, nx), u (N, nu), at times from t on, and after `linearize` its quadratic program."""

    def __init__(
        self,
        objective: Objective,
        N: int,
        substeps: int,
        P: Array | None,
        law: Terminal | None,
        end: MovingEnd | None = None,
    ) -> None:
        """P (nx, nx) >= 0: the weight of x_N's deviation from the goal; None for none. law: about the goal, if any.
        end: what is charged in place of both."""
        plant, self.end = objective.plant, end
        self.objective, self.plant, self.N, self.P = objective, plant, N, P
        self.x, self.u = np.empty((N + 1, plant.nx)), np.empty((N, plant.nu))
        self.forget()
        self.steps = StepSensitivities(plant, objective.dt, substeps=substeps, batch=N)
        kernel = stage_kernel(objective)
        self._stage = kernel.workspace(N)
        self._stage.set(4, plant.nominal_parameters)
        nr, _, nb, _ = kernel.rows[1]
        L = np.zeros((0 if end is None else end.rows, plant.nx)) if P is None else _root(P)
        self.condensed = Condensed(N, plant.nx, plant.nu, nr + plant.nu, nb, L)
        self.recursion = StageRecursion(self.condensed) if self.condensed.long else None
        self._stages, self._held = self.condensed.residual[:, :nr], self.condensed.residual[:, nr:]
        K, M = (np.zeros((plant.nu, plant.nx)), objective.dt * objective.quadratic()[1]) if law is None else law[1::2]
        root = _root(M)
        self._price = L if law is None or len(L) else _root(law.P)
        self._hold = np.zeros((plant.nu, plant.nx + 1 + plant.nu))
        self._hold[: len(root), : plant.nx], self._hold[: len(root), plant.nx + 1 :] = root @ K, root
        self._times = objective.dt * np.arange(N)[:, None]

    def forget(self) -> None:
        """To stay at the goal, undamped: as new."""
        self.t = 0.0
        self.x[:], self.u[:] = self.objective.x_goal, self.objective.u_goal
        self.damping = self.damped = 0.0  # now, and in what was linearised last
        self._reference = self.objective.x_goal  # where an end moves: of the plan that was linearised last

    def linearize(self, *, close: bool = False) -> bool:
        """Form the quadratic program about the plan. False where the plan is no motion: a slope is not finite.

        close: x_N is first put where the plant goes from x_{N-1}.
        """
        nx, t, ready = self.plant.nx, self.t + self._times, self.condensed
        x_next, _, _ = self.steps(self.x[:-1], self.u, t=t)
        if close:
            self.x[-1] = x_next[-1]
        with np.errstate(over="ignore", invalid="ignore"):  # of a plan that has run away: said by False
            _fill(ready.dynamics, nx, x_next - self.x[1:], self.steps.S)
        stage = self._stage
        for k, value in enumerate((t, self.x[:-1], self.u)):
            stage.set(k, value)
        stage.run()
        r, slopes, z, bounded = (stage.get(k) for k in range(4))
        _fill(self._stages, nx, r, slopes)
        self._stages *= np.sqrt(self.objective.dt)
        self.damped = self.damping
        np.multiply(np.sqrt(self.damping), self._hold, out=self._held)
        _fill(ready.bounded, nx, z, bounded)
        with np.errstate(over="ignore", invalid="ignore"):
            if self.end is not None and np.isfinite(self.x[-1]).all():
                self._reference, ready.L[:] = self.end.at(self.x[-1])
                ready.end[:, :nx] = ready.L
            ready.finish(self.x[-1] - self.goal)
            if self.recursion is not None:
                return self.recursion.factor()
            ready.form()
            return bool(np.isfinite(ready.S.sum() + ready.Zd.sum()))

    def hold(self, rough: bool) -> None:
        """Damp what is linearised from now on where a plan is rough, less and less where it is not.

        Damped, an input besides the regulator's feedback costs 1 + `damping` times as much as it would about the goal:
        the plan then changes by that feedback, and otherwise by less (Levenberg and Marquardt).
        """
        self.damping = DAMPING if rough else self.damping / 2 if self.damping > DAMPING / 32 else 0.0

    @property
    def roughness(self) -> float:
        """What the gaps F(x_k, u_k) - x_{k+1} would cost by the regulator's cost-to-go, over the plan's cost.

        Not a number where the plan is no motion.
        """
        nx = self.plant.nx
        with np.errstate(over="ignore", invalid="ignore"):
            gaps = self.condensed.dynamics[:, :, nx] @ self._price.T
            cost = self.condensed.S[nx, nx] if self.recursion is None else self.condensed.unchanged()
            return float(np.vdot(gaps, gaps) / max(cost, 1e-300))

    def move(self, e: Array, d: Array) -> None:
        """Change the plan by du = d (N nu,) and what follows from it and dx_0 = e (nx,)."""
        self.x += self.condensed.states(e, d)
        self.u += d.reshape(self.u.shape)

    def shift(self, tail: Array) -> None:
        """Begin a period later; `tail` (nu,) is the new last input; x_N is left where it was."""
        self.x[:-1], self.u[:-1] = self.x[1:], self.u[1:]
        self.u[-1] = tail
        self.t += self.objective.dt

    @property
    def goal(self) -> Array:
        """The goal (nx,) at the end of the plan."""
        return self.objective.goal_at(self.t + self.N * self.objective.dt) if self.end is None else self._reference

    def cost(self) -> float:
        """The plan's cost, its terminal term included."""
        end = self.condensed.L @ (self.x[-1] - self.goal)
        return self.objective.cost(self.x, self.u, self.t) + float(end @ end)


def _fill(stages: Array, nx: int, value: Array, slopes: Array) -> None:
    """[d/dx, value, d/du] from values (N, n) and slopes (N, n, nx+nu), or (N, n (nx+nu)) row by row."""
    slopes = slopes.reshape(*value.shape, -1) if value.size else np.zeros((*value.shape, stages.shape[2] - 1))
    stages[:, :, :nx], stages[:, :, nx], stages[:, :, nx + 1 :] = slopes[:, :, :nx], value, slopes[:, :, nx:]


def _root(P: Array) -> Array:
    """L (rank, nx) with L'L = P, semidefinite."""
    S = semidefinite_root(P)
    return S[:, S.any(axis=0)].T.copy()

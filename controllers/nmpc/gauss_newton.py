"""Gauss-Newton steps to convergence, each as long as it makes the plan better.

Better by the merit  J + sum_i m_i sum_k |gap_ki| + penalty of bounds,  gap_k = F(x_k, u_k) - x_{k+1}: exact where m_i
is above the i-th costates, so that a solution of the problem is a minimum of it (Nocedal and Wright, "Numerical
Optimization", 2006, Section 18.4). Steps are halved until the merit falls by a share of what the program promises.
"""

from __future__ import annotations

import numpy as np

from .horizon_qp import HorizonProgram

Array = np.ndarray
SHARE = 1e-4  # of the promised decrease
HALVINGS = 14
ABOVE = 2.0  # weight of gaps over the largest costate
ROUNDING = 1e-12  # of the merit


def converge(program: HorizonProgram, x0: Array, limit: int, tolerance: float) -> tuple[int, float]:
    """Steps from the present plan, begun at x0 (nx,), until inputs change by at most `tolerance` of half their range.

    Returns how many, at most `limit`, and the last change; infinity where there was no step, `program.why` says why.
    The program is left linearised about the plan.
    """
    plan = program.plan
    plan.x[0], plan.damping = x0, 0.0
    program.linearize()
    weight = np.zeros(plan.x.shape[1])
    e = np.zeros_like(x0)
    change = np.inf
    for k in range(limit):
        d = program.solve(e)
        if d is None:
            return k, np.inf
        dx = plan.condensed.states(e, d)
        change = float(np.abs(d.reshape(plan.u.shape) / program.input_scale).max())
        np.maximum(weight, ABOVE * np.abs(costates(program, dx, d)).max(axis=0), out=weight)
        before = _merit(program, weight)
        promised = before - _model(program, dx, d)
        base = plan.x.copy(), plan.u.copy()
        for halving in range(HALVINGS + 1):
            length = 0.5**halving
            plan.x[:], plan.u[:] = base[0] + length * dx, base[1] + length * d.reshape(plan.u.shape)
            if program.linearize():
                now = _merit(program, weight)
                if now <= before - SHARE * length * promised + ROUNDING * abs(before):
                    break
        else:
            plan.x[:], plan.u[:] = base
            program.linearize()
            program.why = "no step along the last direction is an improvement"
            return k, change
        if change <= tolerance and halving == 0 and plan.damping == 0:
            return k + 1, change
        if halving or plan.damping:
            plan.hold(halving > 0)
            program.linearize()
    return limit, change


def costates(program: HorizonProgram, dx: Array, d: Array) -> Array:
    """(N, nx): the change of the program's cost by a push of x_{k+1}, from its solution backward."""
    plan, ready = program.plan, program.plan.condensed
    nx, v = plan.x.shape[1], _stage_values(program, dx, d)
    found = np.zeros((plan.N, nx))
    pushed = program.multipliers()
    L = ready.L
    after = 2 * L.T @ (L @ (plan.x[-1] - plan.goal + dx[-1]))
    found[-1] = after
    for k in range(plan.N - 1, 0, -1):
        X, V = ready.residual[k, :, :nx], ready.bounded[k, :, :nx]
        after = ready.dynamics[k, :, :nx].T @ after + 2 * X.T @ (ready.residual[k] @ v[k]) + V.T @ pushed[k - 1]
        found[k - 1] = after
    return found


def _stage_values(program: HorizonProgram, dx: Array, d: Array) -> Array:
    """(N, nx + 1 + nu) rows [dx_k, 1, du_k]."""
    N = program.plan.N
    return np.hstack([dx[:-1], np.ones((N, 1)), d.reshape(N, -1)])


def _merit(program: HorizonProgram, weight: Array) -> float:
    """Of the plan that was linearised last."""
    plan, ready = program.plan, program.plan.condensed
    nx = plan.x.shape[1]
    end = ready.L @ (plan.x[-1] - plan.goal)
    gaps = float(np.abs(ready.dynamics[:, :, nx]).sum(axis=0) @ weight)
    cost = float((ready.residual[:, :, nx] ** 2).sum() + end @ end)
    return cost + gaps + program.charge(ready.bounded[1:, :, nx].ravel())


def _model(program: HorizonProgram, dx: Array, d: Array) -> float:
    """The merit that the program promises for the whole step: no gaps are left."""
    plan, ready = program.plan, program.plan.condensed
    v = _stage_values(program, dx, d)[:, :, None]
    end = ready.L @ (plan.x[-1] - plan.goal + dx[-1])
    z = (ready.bounded @ v)[1:, :, 0].ravel()
    return float(((ready.residual @ v) ** 2).sum() + end @ end) + program.charge(z)

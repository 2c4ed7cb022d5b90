"""What the end of a prediction is charged: the cost-to-go of the regulator about the goal.

The regulator is of the sampled problem that the prediction itself poses: x+ = F(x, u), n RK4 steps, at a cost of
dt |r(x, u)|^2 a period. States that no cost ever sees, as the angle of a hub of which only the speed is weighed, are
left out of it and cost nothing.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
import scipy.linalg as sla

from pliant.controllers import riccati
from pliant.controllers.base.goal_model import HELD
from pliant.plants.core.errors import EquilibriumError, UncontrollableError
from pliant.plants.core.parameters import require_choice, require_finite
from pliant.plants.integration.step_maps import step_limit
from pliant.plants.integration.step_sensitivities import StepSensitivities

if TYPE_CHECKING:
    from pliant.controllers.base.objective import Objective

UNSEEN = 1e-12  # of the largest slope: below it a state does not act on another
MARGIN = 0.9  # of the largest stable step
DEARER = 1.01  # largest ratio of costs of the regulators designed on a coarse and on a fine prediction
FINER, MOST = 4, 1000  # MOST: substeps that are tried
LEFT = 0.02  # share of the cost that a horizon without terminal cost may leave uncounted


class HorizonWarning(UserWarning):
    """A horizon without terminal cost is too short to see what its inputs lead to."""


class Terminal(NamedTuple):
    """(x - goal)'P (x - goal) is the cost from x on under u = u_goal - K (x - goal), without limits."""

    P: np.ndarray  # (nx, nx)
    K: np.ndarray  # (nu, nx)
    poles: np.ndarray  # (n,) of the closed loop, in the z plane
    M: np.ndarray  # (nu, nu): v'M v is what an input v beside the law costs


@runtime_checkable
class MovingEnd(Protocol):
    """The end of a horizon that is charged |L (x - reference)|^2, both of where the plan's end stands."""

    rows: int  # of L

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Reference (nx,) and L (rows, nx) at the plan's end x (nx,)."""
        ...

    def tail(self, x: np.ndarray) -> np.ndarray:
        """The input (nu,) after the plan's end."""
        ...

    def guess(self, x: np.ndarray, periods: int) -> tuple[np.ndarray, np.ndarray]:
        """A first plan (periods + 1, nx), (periods, nu) from about x (nx,)."""
        ...


class _Period(NamedTuple):
    """A control period about the goal in the states that are seen: x+ = A x + B u, cost x'Qx + u'Ru + 2 x'Nu."""

    A: np.ndarray
    B: np.ndarray
    Q: np.ndarray
    R: np.ndarray
    N: np.ndarray
    seen: np.ndarray  # (n,) indices of states


def regulator(objective: Objective, substeps: int) -> Terminal:
    """The Riccati solution about the goal.

    EquilibriumError where the goal is not at rest, UncontrollableError where a mode is not reached.
    """
    nx, nu = objective.plant.nx, objective.plant.nu
    one = _period(objective, substeps)
    names = [objective.plant.states[i].name for i in one.seen]
    found = riccati.dlqr(*one[:5], names=names, dt=objective.dt)
    P, K = np.zeros((nx, nx)), np.zeros((nu, nx))
    P[np.ix_(one.seen, one.seen)], K[:, one.seen] = found.P, found.K
    return Terminal(P, K, found.poles, one.R + one.B.T @ found.P @ one.B)


def fewest_substeps(objective: Objective, *starts: np.ndarray) -> int:
    """RK4 steps a control period that are stable at the goal and at `starts` (nx,), and fine enough to design on.

    Fine enough: the regulator designed on them costs at most DEARER times the least from `starts`, on a map of FINER
    times as many. Where there is no regulator, stable is all that is asked.
    """
    limit = min(step_limit(objective.plant, x, u=objective.u_goal) for x in (objective.x_goal, *starts))
    n = max(1, int(np.ceil(objective.dt / (MARGIN * limit))))
    try:
        while n < MOST and any(_dearer(objective, n, x) > DEARER for x in starts):
            n += 1
    except (EquilibriumError, UncontrollableError):
        pass  # no regulator about this goal: there is nothing to compare
    return n


def wanted_horizon(terminal: Terminal, dt: float) -> float:
    """Time [s] that a prediction without terminal cost must see: until LEFT of the cost of the slowest closed-loop
    mode is left, and a quarter period of the slowest vibration."""
    rates = np.log(terminal.poles[np.abs(terminal.poles) > 0].astype(complex)) / dt
    settled = -np.log(LEFT) / (2 * np.min(-rates.real))
    swings = np.abs(rates.imag[rates.imag != 0])
    return float(max(settled, np.pi / 2 / swings.min() if len(swings) else 0.0))


def end_of(objective: Objective, wanted: Any, substeps: int, horizon: int) -> tuple[np.ndarray | None, Terminal | None]:
    """(P, regulator) of a horizon's end: `wanted` is "riccati", a matrix P (nx, nx) >= 0, or None for no cost.

    There is no regulator where the goal has none and "riccati" does not ask for it. Warns (HorizonWarning) where
    `horizon` periods are too short to do without cost.
    """
    if isinstance(wanted, str):
        require_choice("NMPC", "terminal", wanted, ("riccati",))
        found = regulator(objective, substeps)
        return found.P, found
    P, nx = None, objective.plant.nx
    if wanted is not None:
        P = require_finite("NMPC.terminal", wanted, (nx, nx))
        P = (P + P.T) / 2
        lowest = np.linalg.eigvalsh(P).min()
        if lowest < -1e-9 * np.abs(P).max():
            raise ValueError(f"NMPC.terminal has eigenvalue {lowest:.4g}, must be >= 0")
    try:
        found = regulator(objective, substeps)
    except (EquilibriumError, UncontrollableError):
        return P, None
    needed = wanted_horizon(found, objective.dt)
    if P is None and horizon * objective.dt < needed:
        warnings.warn(
            f"NMPC without terminal cost over {horizon * objective.dt:.3g} s is short: the slowest motion about the "
            f"goal takes {needed:.3g} s; take terminal='riccati', or a horizon of "
            f"{int(np.ceil(needed / objective.dt))} periods",
            HorizonWarning,
            stacklevel=3,
        )
    return P, found


def _period(objective: Objective, substeps: int) -> _Period:
    step = StepSensitivities(objective.plant, objective.dt, substeps=substeps)
    end, A, B = (a[0] for a in step(objective.x_goal[None], objective.u_goal[None]))
    Q, R, N = (objective.dt * weight for weight in objective.quadratic())
    acts = np.abs(A) > UNSEEN * np.abs(A).max()
    seen = np.diag(Q) > 0
    while True:
        more = seen | acts[seen].any(axis=0)
        if (more == seen).all():
            break
        seen = more
    k = np.flatnonzero(seen)
    drift = (end - objective.goal_at(objective.dt))[k]
    if np.abs(drift).max(initial=0.0) > HELD * objective.dt:
        worst = int(np.argmax(np.abs(drift)))
        raise EquilibriumError(
            f"the goal is no equilibrium: {objective.plant.states[k[worst]].name} changes by {drift[worst]:.3g} in a "
            "control period; a regulator about it, and its cost-to-go, need a goal at rest, or its goal_rates",
            float(np.abs(drift[worst])),
        )
    return _Period(A[np.ix_(k, k)], B[k], Q[np.ix_(k, k)], R, N[k], k)


def _dearer(objective: Objective, n: int, start: np.ndarray) -> float:
    """What n substeps' regulator costs from `start` on a finer map, over what the best one does."""
    coarse, fine = _period(objective, n), _period(objective, FINER * n)
    K = riccati.dlqr(*coarse[:5]).K
    best = riccati.dlqr(*fine[:5]).P
    A, B, Q, R, N, seen = fine
    closed = A - B @ K
    if np.abs(np.linalg.eigvals(closed)).max() >= 1:
        return np.inf
    P = sla.solve_discrete_lyapunov(closed.T, Q + K.T @ R @ K - N @ K - K.T @ N.T)
    e = (start - objective.x_goal)[seen]
    least = float(e @ best @ e)
    return float(e @ P @ e) / least if least > 0 else 1.0

"""What a tube MPC is made of: the MPC without tubes, and the model with both laws along its time.

The ancillary law is an LQR of another cost: it is to hold a plan's error small against the limits, not to bring the
machine home cheaply. With z_max and u_max half the ranges of bounded signals and of inputs it weighs

    SMALL of the scene's cost + sum (z_i / z_max,i)^2 + price sum (u_j / u_max,j)^2

and of PRICES that is taken with which the error takes the least of what the goal or nominal leaves to any limit, of
those that leave a plan a range of each.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.linear_quadratic.delay import delayed
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.controllers.mpc.condensed_prediction import laws
from pliant.controllers.mpc.constraints import Limits
from pliant.controllers.mpc.design import Limited, regulator
from pliant.controllers.mpc.ltv_design import follower, problem_along
from pliant.controllers.mpc.steered_weights import step_weights
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.quadratic_cost import signal_rows

from .disturbance_set import DisturbanceSet
from .error_bounds import Course, Tightening, responses, tightening
from .late_tubes import widened
from .tightened_steps import crowding, largest_share, require_room, tightened

Array = np.ndarray
PRICES = (10.0, 3.0, 1.0, 0.3, 0.1)
SMALL = 0.02


class Tubes(NamedTuple):
    """An MPC without tubes, what is needed to make them, and `times` the course and limits count from."""

    made: dict[str, Any]  # arguments of MPC
    courses: Mapping[float, Course]  # by the price of the ancillary law's inputs
    c: Array  # (.., nx) what moves the state besides
    origin: tuple[Array, Array, Array]  # x (.., nx), u (.., nu), bounded signals (.., nb)
    periods: int  # of a plan
    made_before: dict[tuple[float, int], tuple[Array, Array]]  # responses, by price and times

    def rows(self, price: float, times: int) -> tuple[Array, Array]:
        """The responses of a course, one period longer than a plan."""
        key, horizon = (price, times), len(self.made["steps"][0].plan[0])
        if key not in self.made_before:
            self.made_before[key] = responses(self.courses[price], times, self.periods + 1, horizon)
        return self.made_before[key]


class Chosen(NamedTuple):
    """The arguments of an MPC with tightened limits, and the tubes that they are tightened by."""

    made: dict[str, Any]
    course: Course
    taken: Tightening
    price: float


def ancillary_cost(model: LinearModel, Q: Any, R: Any, limits: Limits, price: float) -> tuple[Array, Array]:
    """Q (nx, nx) and R (nu, nu) of the ancillary law: what the limits do not see is weighed by SMALL of the cost."""
    Q, R, _ = step_weights(model, Q, R, None)
    C, _, _ = signal_rows(model, limits.bounded, "TubeMPC.bounds: state or output")
    half = (limits.ceiling - limits.floor) / 2
    size = (limits.high - limits.low) / 2
    Q = SMALL * Q + sum(np.outer(row, row) / h**2 for row, h in zip(C, half) if np.isfinite(h))
    return Q, np.diag(np.where(np.isfinite(size), price / size**2, price * SMALL * np.diag(R)))


def about_point(
    model: LinearModel,
    Q: Any,
    R: Any,
    horizon: int,
    dt: float | None,
    limited: Limited,
    start: Any,
    late: tuple[int, Any] = (0, None),
) -> Tubes:
    """About an equilibrium; late: the delay of the inputs [periods], and what acts before the first does (nu,)."""
    made = regulator(model, (Q, R, None, None), horizon, dt, limited, None, None, ((), None, 0.2, 1e-2), start, late)
    limits, dt, delay = made["limits"], made["dt"], late[0]
    held = delayed(model if model.dt is not None else model.discretize(dt), delay)
    C, D, z0 = signal_rows(held, limits.bounded, "TubeMPC.bounds: state or output")
    Kf, parts = _gain(model, Q, R, dt, start, delay), (held.A[None], held.B[None], C[None], D[None])
    found = {}
    for price in PRICES:
        K = _gain(model, *ancillary_cost(model, Q, R, limits, price), dt, start, delay)
        found[price] = Course(*parts, K[None], Kf[None])
    still = np.zeros((1, len(held.x0)))
    return Tubes(made, found, still, (held.x0[None], held.u0[None], z0[None]), horizon + limited[3], {})


def _gain(model: LinearModel, Q: Any, R: Any, dt: float, start: Any, delay: int) -> Array:
    if model.dt is None:
        law = LQR.design(model, Q, R, dt=dt, start=start, delay=delay)
        return law.K if law.K_past is None else np.hstack([law.K, law.K_past])
    Q, R, N = step_weights(model, Q, R, None)
    return riccati.dlqr(model.A, model.B, Q, R, N, names=model.state_names, dt=dt).K


def along_nominal(ltv: LTVModel, Q: Any, R: Any, horizon: int, limited: Limited) -> Tubes:
    """Along a nominal with nodes dt apart."""
    made = follower(ltv, (Q, R, None), horizon, limited, None, None)
    limits, n = made["limits"], horizon + limited[3]
    models = [ltv.at(k) for k in range(len(ltv.t))]
    rows = [signal_rows(model, limits.bounded, "TubeMPC.bounds: state or output") for model in models]
    C, D, z0 = (np.array([own[i] for own in rows]) for i in range(3))
    A, B, c, *cost = problem_along(ltv, Q, R, None, n)
    past = laws(A, B, c, *cost)
    found = {}
    for price in PRICES:
        _, _, _, *cost = problem_along(ltv, *ancillary_cost(models[-1], Q, R, limits, price), None, n)
        found[price] = Course(A, B, C, D, laws(A, B, c, *cost).K, past.K, past.k)
    return Tubes(made, found, c, (ltv.x, ltv.u, z0), n, {})


def chosen(owner: str, tubes: Tubes, disturbances: DisturbanceSet, times: int, *, empty: bool = False) -> Chosen:
    """Tubes of plans made at times 0 .. times - 1, the last of which stays, with the price that crowds limits least.

    InfeasibleError where they take a whole range, unless it may be `empty`.
    """
    made, nx = tubes.made, len(tubes.made["reads"])
    if len(disturbances.noise) != nx:
        raise ValueError(f"{owner}.disturbances are of {len(disturbances.noise)} states, must be of {nx}, the model's")
    limits, disturbances = made["limits"], widened(disturbances, tubes.origin[0].shape[1])
    taken = {p: tightening(one, tubes.rows(p, times), disturbances, times) for p, one in tubes.courses.items()}

    def worth(price: float) -> tuple[bool, float]:
        share = largest_share(taken[price], limits)[0]
        return share >= 1.0, share if share >= 1.0 else crowding(taken[price], limits, tubes.origin)

    price = min(taken, key=worth)
    course, found = tubes.courses[price], taken[price]
    if not empty:
        require_room(owner, found, limits)
    steps = tightened(made["steps"], found, limits, course)
    return Chosen({**made, "steps": steps}, course, found, price)

"""The quadratic programs of linear MPC for the elastic hub, stated and solved otherwise.

The reference program keeps states and inputs as variables and is solved by qpOASES: another formulation, another
method. Exceeding a bound by s half ranges costs penalty * (s + 0.0005 s^2) there, as daqp_model.py says.
"""

import functools

import casadi as ca
import numpy as np
from elastic_hub import DT, LINK, Q, R

from pliant.controllers import riccati


def sampled_problem(model=LINK, Q=Q, R=R):
    """A, B, Q, R, N of a step and the cost to go."""
    rows = np.vstack([np.eye(4), model.C])
    names = [*model.state_names, *model.output_names]
    weight = sum(w * np.outer(rows[names.index(n)], rows[names.index(n)]) for n, w in Q.items())
    step = riccati.sampled(model.A, model.B, weight, np.diag(list(R.values())), dt=DT)
    return *step, riccati.dlqr(*step).P


def reference(x, N, *, low=-np.inf, high=np.inf, last=(0.0, 0.0), soft=None, **options):
    """First inputs (N, 2) of the program in states, inputs and excesses of |bend| <= bound, or None."""
    solver, lbg, ubg = program(N, *map(tuple, np.broadcast_arrays(low, high, [0, 0])[:2]), soft is not None, **options)
    found = solver(lbg=lbg, ubg=ubg, p=[*x, *last, soft or 0.0])
    if not solver.stats()["success"]:
        return None
    return np.array(found["x"])[4 * (N + 1) :][: 2 * N].reshape(N, 2)


@functools.cache
def program(N, low, high, softened, *, change=np.inf, bound=np.inf, blocks=()):
    """The solver, a function of the state, the last inputs and the price of an excess, and its rows' limits."""
    Ad, Bd, Qd, Rd, Nd, P = sampled_problem()
    xs, us, s = ca.MX.sym("x", 4, N + 1), ca.MX.sym("u", 2, N), ca.MX.sym("s", N)
    x, last, price = ca.MX.sym("x0", 4), ca.MX.sym("last", 2), ca.MX.sym("price")
    cost = ca.bilin(P, xs[:, N])
    g, lbg, ubg = [xs[:, 0] - x], [0.0] * 4, [0.0] * 4

    def hold(expression, lowest, highest):
        g.append(expression)
        size = expression.numel()
        lbg.extend(np.broadcast_to(lowest, size))
        ubg.extend(np.broadcast_to(highest, size))

    for j in range(N):
        cost += ca.bilin(Qd, xs[:, j]) + ca.bilin(Rd, us[:, j]) + 2 * ca.bilin(Nd, xs[:, j], us[:, j])
        hold(xs[:, j + 1] - Ad @ xs[:, j] - Bd @ us[:, j], 0, 0)
        hold(us[:, j], low, high)
        if np.isfinite(change):
            before = last if j == 0 else us[:, j - 1]
            hold(us[:, j] - before, -change, change)
        if np.isfinite(bound):
            bend = xs[1, j + 1]
            hold(bend - bound * s[j], -np.inf, bound)
            hold(bend + bound * s[j], -bound, np.inf)
            hold(s[j], 0.0, np.inf if softened else 0.0)
            cost += price * (s[j] + 0.0005 * s[j] ** 2) if softened else 0
    for end, length in zip(np.cumsum(blocks), blocks):
        for j in range(end - length, end - 1):
            hold(us[:, j + 1] - us[:, j], 0, 0)
    if not np.isfinite(bound) or not softened:
        cost += ca.sumsqr(s)  # unused
    stated = {
        "x": ca.vertcat(ca.vec(xs), ca.vec(us), s),
        "p": ca.vertcat(x, last, price),
        "f": cost,
        "g": ca.vertcat(*g),
    }
    options = {"printLevel": "none", "error_on_fail": False, "nWSR": 20_000}
    return ca.qpsol("reference", "qpoases", stated, options), lbg, ubg

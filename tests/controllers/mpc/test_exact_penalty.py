"""Bounds that a plan can keep are kept, whatever the sampled price: against programs by HiGHS and SLSQP, no DAQP."""

import numpy as np
from scipy.optimize import linprog, minimize

from pliant.controllers import MPC
from pliant.plants.linear.lti import LinearModel


def problem(seed):
    """A random sampled plant, its bounds and a state within them."""
    rng = np.random.default_rng(seed)
    nx, N = int(rng.integers(2, 4)), int(rng.integers(3, 7))
    A = rng.standard_normal((nx, nx))
    A *= rng.uniform(0.7, 1.3) / np.abs(np.linalg.eigvals(A)).max()
    B = rng.standard_normal((nx, 1))
    names = [f"x{i}" for i in range(nx)]
    model = LinearModel.from_matrices(A, B, states=names, inputs=["u"], dt=0.1)
    ends = {n: (-rng.uniform(0.5, 2), rng.uniform(0.5, 2)) for n in names}
    x = np.array([rng.uniform(*ends[n]) for n in names])
    return model, ends, x, N, float(10 ** rng.uniform(-3, 1))


def rows(model, ends, x, N):
    """G u <= g: the bounds at steps 1 .. N, for u (N,)."""
    nx = len(x)
    G, g, left, right = np.zeros((nx, N)), x, [], []
    for j in range(N):
        G, g = model.A @ G, model.A @ g
        G[:, j] += model.B[:, 0]
        for i, (low, high) in enumerate(ends.values()):
            left += [G[i].copy(), -G[i]]
            right += [high - g[i], g[i] - low]
    return np.array(left), np.array(right)


def check(seed):
    """'kept' or 'none keeps', from the linear program of the least excess; AssertionError where MPC says otherwise."""
    model, ends, x, N, effort = problem(seed)
    G, g = rows(model, ends, x, N)
    widened = np.hstack([G, -np.ones((len(G), 1))])
    least = linprog(np.r_[np.zeros(N), 1.0], A_ub=widened, b_ub=g, bounds=[(-1, 1)] * N + [(-10, None)])
    if abs(least.fun) < 1e-5:
        return "on the edge"
    try:
        law = MPC.design(model, np.eye(len(x)), [[effort]], horizon=N, limits=(-1, 1), bounds=ends)
    except Exception as error:  # a plant that no input stabilises is none of this test's
        if type(error).__name__ != "UncontrollableError":
            raise
        return "no regulator"
    law.act(0.0, x)
    u = law.plan.inputs()[:, 0]
    worst = float((G @ u - g).max())
    if least.fun > 0:
        assert law.record.violations == 1 and worst > 0, (seed, least.fun, worst)
        return "none keeps"
    assert worst <= 1e-6 and law.record.violations == 0, (seed, least.fun, worst)
    P = law_cost(model, effort, len(x))

    def cost(u):
        z, total = x, 0.0
        for v in u:
            total, z = total + z @ z + effort * v * v, model.A @ z + model.B[:, 0] * v
        return total + z @ P @ z

    options = {"ftol": 1e-13, "maxiter": 300}
    limit = {"type": "ineq", "fun": lambda u: g - G @ u, "jac": lambda u: -G}
    other = minimize(cost, np.clip(least.x[:N], -1, 1), bounds=[(-1, 1)] * N, constraints=limit, options=options)
    if other.success and (G @ other.x - g).max() < 1e-9:
        assert cost(u) <= other.fun * (1 + 1e-6) + 1e-9, (seed, cost(u), other.fun)
    return "kept"


def law_cost(model, effort, nx):
    """The cost to go of the regulator by the recursion itself."""
    P = np.eye(nx)
    for _ in range(400):
        K = np.linalg.solve(effort + model.B.T @ P @ model.B, model.B.T @ P @ model.A)
        P = np.eye(nx) + model.A.T @ P @ (model.A - model.B @ K)
    return P


def test_a_bound_is_exceeded_only_where_none_keeps_it():
    found = [check(seed) for seed in range(14)]
    assert found.count("kept") >= 5 and found.count("none keeps") >= 2


def test_the_price_found_from_samples_alone_exceeds_a_bound_that_can_be_kept():
    """A cart-pole within its bounds: u = -4.146 by the hard program of another solver (qpOASES)."""
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [0, 9.81, 0, 0], [0, 65.4, 0, 0]])
    names = ["p", "th", "v", "w"]
    cart = LinearModel.from_matrices(A, [[0], [0], [2], [1 / 0.15]], states=names, inputs=["F"])
    bounds = {"p": (-3, 10), "th": (-2, 9), "v": (-2.1, 8), "w": (-2.5, 7)}
    x = np.array([-0.15178016, 0.18706709, -1.77295158, -0.0791845])
    options = {"dt": 0.05, "limits": ([-12], [10]), "bounds": bounds}
    law = MPC.design(cart, np.diag([100.0, 10, 1, 1]), [[0.1]], **options)
    naive = MPC.design(cart, np.diag([100.0, 10, 1, 1]), [[0.1]], penalty=law.penalty, **options)
    naive.act(0.0, x)
    assert naive.record.worst[2] > 0.2
    assert abs(law.act(0.0, x)[0] + 4.146) < 2e-3 and law.record.worst.max() < 1e-6

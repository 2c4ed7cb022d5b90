"""Bounds that a plan can keep are kept, whatever the sampled price: against programs by HiGHS and SLSQP, no DAQP."""

import numpy as np
import predictive
from scipy.optimize import minimize

from pliant.controllers import MPC
from pliant.plants.linear.lti import LinearModel


def test_a_sample_of_the_campaign_finds_no_wrong_claim():
    """Bounds that are exceeded only where none keeps them, and targets; the whole is run by `make campaign`.

    The first four passed a limit: states and inputs in far apart units left the target's program badly scaled.
    """
    rows = [predictive.run(seed) for seed in (474, 1258, 1414, 1438, *range(100_000, 100_040))]
    assert not [row for row in rows if row["wrong"]], rows
    found = [row["found"] for row in rows]
    assert sum("kept" in f for f in found) >= 5 and sum("none keeps" in f for f in found) >= 1
    assert found.count("met") >= 5 and found.count("missed") >= 5


def test_the_plan_within_the_bounds_is_the_cheapest_of_them():
    """Against SLSQP: the cost of a state inside, where the least excess says that a plan keeps the bounds."""
    tried = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        nx, N, effort = int(rng.integers(2, 4)), int(rng.integers(3, 7)), float(10 ** rng.uniform(-3, 1))
        A, B = predictive.stable(rng, nx, 0.7, 1.3), rng.standard_normal((nx, 1))
        names = [f"x{i}" for i in range(nx)]
        model = LinearModel.from_matrices(A, B, states=names, inputs=["u"], dt=0.1)
        ends = {n: (-rng.uniform(0.5, 2), rng.uniform(0.5, 2)) for n in names}
        x = np.array([rng.uniform(*ends[n]) for n in names])
        least, G, g = predictive.least_excess(A, B, x, ends, N, None)
        if least > -predictive.EDGE:
            continue
        law = MPC.design(model, np.eye(nx), [[effort]], horizon=N, limits=(-1, 1), bounds=ends)
        law.act(0.0, x)
        P = cost_to_go(A, B, effort)

        def cost(u, A=A, B=B, x=x, P=P, effort=effort):
            z, total = x, 0.0
            for v in u:
                total, z = total + z @ z + effort * v * v, A @ z + B[:, 0] * v
            return total + z @ P @ z

        limit = {"type": "ineq", "fun": lambda u, G=G, g=g: g - G @ u, "jac": lambda u, G=G: -G}
        options = {"ftol": 1e-13, "maxiter": 300}
        other = minimize(cost, np.zeros(N), bounds=[(-1, 1)] * N, constraints=limit, options=options)
        if other.success and (G @ other.x - g).max() < 1e-9:
            tried += 1
            assert cost(law.plan.inputs()[:, 0]) <= other.fun * (1 + 1e-6) + 1e-9
    assert tried >= 4


def cost_to_go(A, B, effort):
    """Of the regulator with unit weights of the state, by the recursion itself."""
    P = np.eye(len(A))
    for _ in range(400):
        K = np.linalg.solve(effort + B.T @ P @ B, B.T @ P @ A)
        P = np.eye(len(A)) + A.T @ P @ (A - B @ K)
    return P

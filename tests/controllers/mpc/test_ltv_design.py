"""MPC along a nominal: what its plan ends with, of a model whose outputs feel the inputs more and more."""

import numpy as np
from scipy.linalg import solve_discrete_are

from pliant.controllers import MPC
from pliant.plants.linear.ltv import LTVModel

DT, NODES = 0.05, 41


def growing() -> LTVModel:
    """A driven hub whose measured acceleration feels the torque by 0.2 at first and by 2 at the end."""
    t, z = DT * np.arange(NODES), np.zeros
    A, B = np.array([[0.0, 1.0], [-4.0, -0.1]]), np.array([[0.0], [1.0]])
    D = np.linspace(0.2, 2.0, NODES)[:, None, None]
    parts = (
        np.tile(A, (NODES, 1, 1)),
        np.tile(B, (NODES, 1, 1)),
        z((NODES, 2, 0)),
        np.tile([[-4.0, -0.1]], (NODES, 1, 1)),
    )
    rows = {"c": z((NODES, 2)), "x": z((NODES, 2)), "u": z((NODES, 1)), "y": z((NODES, 1))}
    names = {"states": ("angle", "rate"), "inputs": ("torque",), "disturbances": (), "outputs": ("felt",)}
    return LTVModel(t, *parts, D, z((NODES, 1, 0)), **rows, **names)


def test_the_cost_to_go_at_the_end_is_that_of_the_last_weights():
    """R + w D'D and the cross term w C'D at the last node, by SciPy's solver of the Riccati equation."""
    ltv, x = growing(), np.array([0.3, -0.2])
    last = ltv.at(-1).discretize(DT)
    w, weights = 3.0, ({"felt": 3.0, "angle": 1.0}, {"torque": 0.1})

    def cost_to_go(k):
        C, D = ltv.C[k], ltv.D[k]
        Q, R, N = w * C.T @ C + np.diag([1.0, 0.0]), np.array([[0.1]]) + w * D.T @ D, w * C.T @ D
        return solve_discrete_are(last.A, last.B, DT * Q, DT * R, s=DT * N)

    found, told, other = (MPC.along(ltv, *weights, horizon=8, P=P) for P in (None, cost_to_go(-1), cost_to_go(0)))
    for k in (0, 30, NODES - 1):
        u = told.act(ltv.t[k], x)
        np.testing.assert_allclose(found.act(ltv.t[k], x), u, rtol=1e-9)
        assert abs(other.act(ltv.t[k], x) - u) > 1e-4 * abs(u)

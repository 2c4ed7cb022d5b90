"""MPC along a nominal: the time-varying regulator where nothing limits it, and what its plan ends with."""

import numpy as np
import pytest
from elastic_hub import DT, LINK, STATES, A, B, C
from scipy.linalg import solve_discrete_are

from pliant.controllers import MPC, riccati
from pliant.plants.linear.ltv import LTVModel

NODES = 41


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


def lq_plan(As, Bs, cs, Q, R, P, x):
    """Inputs (n, nu) of the affine time-varying problem, by one dense least-squares solve."""
    n, nx, nu = len(As), len(x), Bs.shape[2]
    rows, rest = [], []
    L, r, p = np.linalg.cholesky(Q).T, np.linalg.cholesky(R).T, np.linalg.cholesky(P).T
    G, g = np.zeros((nx, n * nu)), np.array(x, dtype=float)
    for j in range(n):
        one = np.zeros((nu, n * nu))
        one[:, j * nu : (j + 1) * nu] = np.eye(nu)
        rows += [L @ G, r @ one]
        rest += [L @ g, np.zeros(nu)]
        G, g = As[j] @ G + Bs[j] @ one, As[j] @ g + cs[j]
    rows.append(p @ G)
    rest.append(p @ g)
    return np.linalg.lstsq(np.vstack(rows), -np.concatenate(rest), rcond=None)[0].reshape(n, nu)


def swinging(nodes=61):
    """An LTV model whose stiffness changes along the way, about a nominal that is no motion of it, ending at rest."""
    t = DT * np.arange(nodes)
    s = np.minimum(t / 2.0, 1.0)
    As = np.array([A + np.array([[0] * 4, [0] * 4, [-k, 0, 0, 0], [0.5 * k, 0, 0, 0]]) for k in 3 * np.sin(np.pi * s)])
    c = np.outer(np.sin(np.pi * s) ** 2, [0.0, 0.0, 0.3, -0.2])
    x = np.outer(s - 1, [0.4, 0, 0, 0])
    zeros = np.zeros((nodes, 4, 0)), np.zeros((nodes, 2, 0))
    own = {k: getattr(LINK, k) for k in ("states", "inputs", "disturbances", "outputs")}
    repeat = [np.broadcast_to(M, (nodes, *M.shape)) for M in (B, C, np.zeros((2, 2)))]
    return LTVModel(
        t,
        As,
        repeat[0],
        zeros[0],
        repeat[1],
        repeat[2],
        zeros[1],
        c,
        x,
        np.outer(np.cos(t), [0.3, 0.1]),
        x @ C.T,
        **own,
    )


def test_along_a_nominal_without_limits_it_is_the_time_varying_regulator():
    ltv, N = swinging(), 30
    weight, effort = np.diag([40.0, 5.0, 1.0, 1.0]), np.diag([0.02, 0.05])
    controller = MPC.along(ltv, weight, effort, horizon=10)
    last = ltv.at(-1).discretize(DT)
    P = riccati.dlqr(last.A, last.B, DT * weight, DT * effort).P
    As, Bs, cs = ltv.transition()
    for k in (0, 17, 59):
        # the rest of the nominal, then N more steps at its end: what the controller's terminal weight stands for
        ends = (np.repeat(M[None], N, axis=0) for M in (last.A, last.B, np.zeros(4)))
        parts = [np.concatenate([own[k:], end]) for own, end in zip((As, Bs, cs), ends)]
        xi = STATES[k % 7]
        expected = lq_plan(*parts, DT * weight, DT * effort, P, xi)[0]
        np.testing.assert_allclose(controller.act(k * DT, ltv.x[k] + xi) - ltv.u[k], expected, atol=1e-8)


def test_along_a_nominal_limits_hold_and_warm_starts_do_not_matter():
    ltv = swinging()
    weight, effort = np.diag([40.0, 5.0, 1.0, 1.0]), np.diag([0.02, 0.05])
    options = {"horizon": 10, "limits": (-1.0, 1.0), "bounds": {"bend": (-0.004, 0.004)}}
    warm, cold = MPC.along(ltv, weight, effort, **options), MPC.along(ltv, weight, effort, **options)
    As, Bs, cs = ltv.transition()
    xi = np.array([-0.4, 0.0, 0.0, 0.0])
    for k in range(60):
        cold.reset()
        u = warm.act(k * DT, ltv.x[k] + xi)
        np.testing.assert_allclose(cold.act(k * DT, ltv.x[k] + xi), u, atol=1e-7)
        assert np.abs(u).max() <= 1.0
        xi = As[k] @ xi + Bs[k] @ (u - ltv.u[k]) + cs[k]
    assert warm.record.limited > 20 and not warm.record.failures
    assert np.abs(xi).max() < 0.02


def test_an_input_price_that_is_no_price_is_refused_at_the_end_of_the_way_too():
    ltv = swinging()
    with pytest.raises(ValueError, match=r"MPC\.R"):
        MPC.along(ltv, np.eye(4), np.zeros((2, 2)), horizon=10, P=np.eye(4))

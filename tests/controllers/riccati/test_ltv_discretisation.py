"""Models that vary, sampled: what a step does and costs, and what white noise leaves, by integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from varying_spring import N, Q, R, along, spring, varying

from pliant.controllers import riccati
from pliant.plants.linear.ltv import LTVModel


def test_sampled_along_a_constant_model_is_sampled():
    A, B, c = varying(0.3)
    t = np.linspace(0.0, 0.4, 3)
    found = riccati.sampled_along(along(t, 3 * [(A, B, c)]), Q, R, N)
    exact = riccati.sampled(A, B, Q, R, N, dt=0.2)
    for name in ("A", "B", "Q", "R", "N"):
        np.testing.assert_allclose(getattr(found, name)[1], getattr(exact, name), rtol=1e-12, atol=1e-14)


def test_sampled_along_charges_what_an_integration_charges():
    model, x0, u = spring(81), np.array([0.4, -0.3]), np.array([0.9])
    found = riccati.sampled_along(model, Q, R, N)

    def rate(s, y):
        A, B, c = varying(s)
        x = y[:2]
        return [*(A @ x + B @ u + c), x @ Q @ x + u @ R @ u + 2 * x @ N @ u]

    i = 17
    end = solve_ivp(rate, (model.t[i], model.t[i + 1]), [*x0, 0.0], rtol=1e-12, atol=1e-14).y[:, -1]
    step = [m[i] for m in found]
    A, B, c, Qi, Ri, Ni, q, s, r = step
    np.testing.assert_allclose(A @ x0 + B @ u + c, end[:2], atol=1e-9)
    cost = x0 @ Qi @ x0 + u @ Ri @ u + 2 * x0 @ Ni @ u + 2 * q @ x0 + 2 * s @ u + r
    assert cost == pytest.approx(end[2], rel=1e-7)


def test_covariance_of_white_noise_along_a_model_that_varies():
    """dP/dt = A P + P A' + E W E', P(0) = 0, by Dormand and Prince's method; of fourth order in the distance."""
    W, worst = np.array([[0.7]]), []

    def rate(s, y):
        A, E, _ = varying(s)
        P = y.reshape(2, 2)
        return (A @ P + P @ A.T + E @ W @ E.T).ravel()

    right = solve_ivp(rate, (0.0, 2.0), np.zeros(4), "DOP853", rtol=1e-12, atol=1e-14).y[:, -1].reshape(2, 2)
    for nodes in (21, 41):
        t = np.linspace(0.0, 2.0, nodes)
        parts = [varying(s) for s in t]
        A, E = (np.array([part[i] for part in parts]) for i in (0, 1))
        none, names = np.zeros, (("a", "b"), (), ("w",), ())
        model = LTVModel(
            *(t, A, none((nodes, 2, 0)), E, none((nodes, 0, 2)), none((nodes, 0, 0)), none((nodes, 0, 1))),
            *(none((nodes, 2)), none((nodes, 2)), none((nodes, 0)), none((nodes, 0))),
            **dict(zip(("states", "inputs", "disturbances", "outputs"), names)),
        )
        P = np.zeros((2, 2))
        for step, more in zip(model.transition()[0], riccati.noise_along(model, W)):
            P = step @ P @ step.T + more
        worst.append(np.abs(P - right).max() / right.max())
    assert worst[0] < 1e-4 and worst[1] < worst[0] / 12

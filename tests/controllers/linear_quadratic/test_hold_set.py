"""The set that a held law does not leave, and the funnel that ends in it: rolled out from the boundary."""

import numpy as np
import pytest

from pliant.controllers import TVLQR, riccati
from pliant.controllers.linear_quadratic.hold_set import Hold, gain, invariant
from pliant.plants import LTVModel, Signal

DT, T = 0.02, 50


def constant(A, B):
    """An LTV model with constant matrices about rest at zero."""
    nx, nu, n = len(A), B.shape[1], T + 1
    zeros, each = np.zeros, lambda M: np.tile(M, (n, 1, 1))
    signals = [tuple(Signal(f"{letter}{i}", "") for i in range(k)) for letter, k in (("x", nx), ("u", nu), ("y", nx))]
    none = zeros((n, nx, 0))
    parts = (each(A), each(B), none, each(np.eye(nx)), zeros((n, nx, nu)), none)
    rest = (zeros((n, nx)), zeros((n, nx)), zeros((n, nu)), zeros((n, nx)))
    return LTVModel(DT * np.arange(n), *parts, *rest, signals[0], signals[1], (), signals[2])


def worst_input(law, step, K, seed):
    """The largest |u| of the held law without limits from the boundary of the funnel's last ellipsoid."""
    rng, S, level, worst = np.random.default_rng(seed), law.funnel.P[-1], law.funnel.level[-1], 0.0
    for _ in range(30):
        e = rng.standard_normal(len(S))
        e *= np.sqrt(level / (e @ S @ e))
        for _ in range(200):
            worst = max(worst, float(np.abs(law.u[-1] - K @ e).max()))
            e = (step.A - step.B @ K) @ e
    return worst


@pytest.mark.every(2)
@pytest.mark.parametrize("seed", range(8))
def test_no_input_passes_a_limit_from_inside_whatever_the_weight_of_the_end(seed):
    rng = np.random.default_rng(seed)
    A, B = np.array([[0, 1.0], [-100 * rng.uniform(0.1, 2), -0.1]]), np.array([[0], [1.0]])
    step = riccati.sampled(A, B, np.eye(2), np.eye(1), dt=DT)
    K = riccati.dlqr(*step).K
    L = rng.standard_normal((2, 2))
    law = TVLQR.design(
        constant(A, B), np.eye(2), np.eye(1), end=L @ L.T, hold=(K, np.zeros(2), np.zeros(1)), limits=(-1, 1)
    )
    assert law.funnel.level[-1] > 0 and worst_input(law, step, K, seed) <= 1 + 1e-9
    P, F, furthest = L @ L.T, step.A - step.B @ K, 0.0
    toward = np.linalg.solve(P, K[0])  # the same level rule, with the weight of the end itself: |K e| <= 1 on its edge
    for k in range(200):  # the largest |K F^k e| over e'P e <= 1 / (K P^-1 K')
        row = K[0] @ np.linalg.matrix_power(F, k)
        furthest = max(furthest, np.sqrt(row @ np.linalg.solve(P, row) / (K[0] @ toward)))
    assert gain(F, P, P) > 1 and furthest > 1.01  # it asks for more than the limit
    entered = law.funnel
    x = rng.standard_normal(2)
    x *= np.sqrt(entered.level[0] / (x @ entered.P[0] @ x)) * 0.999
    assert entered.inside(0.0, x)
    for k in range(T):
        x = step.A @ x + step.B @ (law._offsets[k] - law.K[k] @ x)
    assert x @ entered.P[-1] @ x <= entered.level[-1]  # the motion ends in the set that the held law keeps


def test_a_law_that_does_not_hold_has_no_set_and_without_one_nothing_is_inside():
    A, B = np.array([[0, 1.0], [-100.0, -0.1]]), np.array([[0], [1.0]])
    away = np.array([[-300.0, 0.0]])
    law = TVLQR.design(constant(A, B), np.eye(2), np.eye(1), hold=(away, np.zeros(2), np.zeros(1)), limits=(-1, 1))
    assert not law.funnel.level.any()
    free = TVLQR.design(constant(A, B), np.eye(2), np.eye(1), end=np.eye(2), limits=(-1, 1))
    assert free.funnel.level[0] > 0 and not free.funnel.inside(DT * T, np.full(2, 1e-9))


def test_a_goal_that_does_not_rest_needs_a_level_above_what_it_is_pushed_to():
    """x+ = x/2 + g: |x| <= c is kept from c = 2 g on."""
    one = np.eye(1)
    hold = Hold(one, one, one / 2, np.array([0.3]), np.eye(2))
    S, least = invariant(hold, one)
    assert least == pytest.approx(0.6) and one == S
    A, B, K = np.array([[0, 1.0], [-100, -1.0]]), np.array([[0], [1.0]]), np.array([[0.1, 0.1]])
    goal, rng, step = np.array([0.5, 0.0]), np.random.default_rng(0), riccati.sampled(A, B, np.eye(2), np.eye(1), dt=DT)
    for limit in (0.01, 1e3):  # a spring pushes the mass from its goal, by 50 m/s^2
        held = (K, goal, np.zeros(1))
        law = TVLQR.design(constant(A, B), np.eye(2), np.eye(1), end=np.eye(2), hold=held, limits=(-limit, limit))
        S, level, us = law.funnel.P[-1], law.funnel.level[-1], []
        for _ in range(20 if level else 0):
            x = rng.standard_normal(2)
            x = goal + x * np.sqrt(level / (x @ S @ x))
            for _ in range(100):
                us.append(float(np.abs(K @ (x - goal))[0]))
                x = step.A @ x - step.B @ K @ (x - goal)
        assert max(us, default=0.0) <= limit + 1e-9
        assert level > 0 or limit < 0.05  # at rest the law asks for 0.05

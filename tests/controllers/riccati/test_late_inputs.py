"""Regulators of late inputs: the model event by event, the Riccati equation of the states with the delay, ranges."""

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from pliant.controllers import riccati
from pliant.controllers.riccati.late_inputs import (
    _drawn,
    ahead,
    delay_range,
    late_lqr,
    late_period,
    past_of,
    periods_of,
    radii,
)
from pliant.plants import PliantError

DT = 0.1
A = np.array([[0.0, 1.0], [2.0, -0.3]])  # falls by itself
B = np.array([[0.0], [1.0]])
Q, R, N = np.diag([2.0, 0.1]), np.array([[0.05]]), np.array([[0.01], [0.02]])


def moved(x, u, h):
    """x after h under u, by one matrix exponential."""
    whole = expm(h * np.block([[A, B], [np.zeros((1, 3))]]))
    return whole[:2, :2] @ x + whole[:2, 2] * u


def charged(x, u, h, parts=400):
    """Simpson's sum of the rate of cost over h."""
    t = np.linspace(0.0, h, 2 * parts + 1)
    z = np.array([np.append(moved(x, u, s), u) for s in t])
    rate = np.einsum("ki,ij,kj->k", z, np.block([[Q, N], [N.T, R]]), z)
    return h / (6 * parts) * (rate[0] + rate[-1] + 4 * rate[1::2].sum() + 2 * rate[2:-1:2].sum())


def on_time():
    return riccati.dlqr(*riccati.sampled(A, B, Q, R, N, dt=DT))


@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0, 1.7, 2.0])
def test_a_period_event_by_event(delay):
    past = past_of(delay) + 1
    found = late_period(A, B, Q, R, N, DT, delay, past)
    rng = np.random.default_rng(3)
    x, u = rng.normal(size=2), rng.normal(size=past + 1)  # the oldest input first
    m, f = periods_of(delay)
    x1 = moved(x, u[past - m - 1], f * DT)
    x2 = moved(x1, u[past - m], (1 - f) * DT)
    z = np.concatenate([x, u])
    np.testing.assert_allclose(found.step @ z, np.concatenate([x2, u[1:]]), atol=1e-12)
    wanted = (charged(x, u[past - m - 1], f * DT) if f else 0.0) + charged(x1, u[past - m], (1 - f) * DT)
    assert z @ found.cost @ z == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("delay", [0.4, 1.0, 2.3])
def test_a_known_delay_is_the_riccati_equation_of_all_states(delay):
    found = late_lqr(A, B, Q, R, N, dt=DT, delays=(delay, delay), on_time=on_time())
    K, P, S = _drawn([late_period(A, B, Q, R, N, DT, delay, past_of(delay))], found.P + np.eye(len(found.P)))
    np.testing.assert_allclose(found.K, K, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found.P, P, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found.S, S, rtol=1e-7)


def test_against_scipy_where_its_equation_is_regular():
    """Half a period late, an input is charged in its own period: R > 0, as solve_discrete_are needs."""
    found = late_lqr(A, B, Q, R, N, dt=DT, delays=(0.5, 0.5), on_time=on_time())
    one = late_period(A, B, Q, R, N, DT, 0.5, 1)
    F, G, H = one.step[:, :3], one.step[:, 3:], one.cost
    P = solve_discrete_are(F, G, H[:3, :3], H[3:, 3:], s=H[:3, 3:])
    np.testing.assert_allclose(found.P, P, rtol=1e-8)
    np.testing.assert_allclose(found.K, np.linalg.solve(H[3:, 3:] + G.T @ P @ G, H[3:, :3] + G.T @ P @ F), rtol=1e-8)


def test_the_state_that_is_met():
    x, u = np.array([0.3, -0.2]), np.array([1.0, -2.0])
    wanted = moved(moved(x, u[0], 0.25 * DT), u[1], DT)
    np.testing.assert_allclose(ahead(A, B, DT, 1.25) @ np.concatenate([x, u]), wanted, atol=1e-13)
    assert ahead(A, B, DT, 0.0).tolist() == np.eye(2).tolist()


def test_a_range_is_the_best_law_for_delays_drawn_anew():
    """Its mean cost by Monte Carlo over drawn delays is x'P x, and no nearby gain has a smaller one."""
    found = late_lqr(A, B, Q, R, N, dt=DT, delays=(0.0, 1.0), on_time=on_time())
    points = [late_period(A, B, Q, R, N, DT, d, 1) for d in (0.0, 0.5, 1.0)]
    rng = np.random.default_rng(0)
    order = rng.integers(0, 3, (1000, 120))

    def mean_cost(K):
        z, cost = np.tile([1.0, 0.0, 0.0], (len(order), 1)), np.zeros(len(order))
        steps, costs = np.stack([p.step for p in points]), np.stack([p.cost for p in points])
        for column in order.T:
            whole = np.hstack([z, -z @ K.T])
            cost += np.einsum("ki,kij,kj->k", whole, costs[column], whole)
            z = np.einsum("kij,kj->ki", steps[column], whole)
        return cost.mean()

    own = mean_cost(found.K)
    assert own == pytest.approx(found.P[0, 0], rel=0.03)
    for i in range(3):
        for way in (0.2, -0.2):
            assert mean_cost(found.K + way * np.abs(found.K).max() * np.eye(3)[i]) > own


def test_a_range_is_borne_where_the_naive_law_and_the_one_for_its_end_are_not():
    plant = np.array([[0.0, 1.0], [-400.0, -0.1]])  # a mode of 20 rad/s, two radians a period
    stiff = np.diag([1e4, 10.0]), np.array([[1e-3]]), np.zeros((2, 1))
    without = riccati.dlqr(*riccati.sampled(plant, B, *stiff, dt=DT))
    looked = [late_period(plant, B, *stiff, DT, d, 1) for d in np.linspace(0, 1, 9)]
    naive = np.hstack([without.K, [[0.0]]])
    known = late_lqr(plant, B, *stiff, dt=DT, delays=(1.0, 1.0), on_time=without)
    both = late_lqr(plant, B, *stiff, dt=DT, delays=(0.0, 1.0), on_time=without)
    assert radii(looked, naive).max() > 1 and radii(looked, known.K).max() > 1 > radii(looked, both.K).max()


def test_a_range_that_is_too_wide_is_refused():
    falls = np.array([[0.0, 1.0], [100.0, 0.0]])  # e-fold in one period
    without = riccati.dlqr(*riccati.sampled(falls, B, Q, R, N, dt=DT))
    with pytest.raises(PliantError, match=r"delay|no law for all delays"):
        late_lqr(falls, B, Q, R, N, dt=DT, delays=(0.0, 6.0), on_time=without)


def test_bad_input():
    assert delay_range("LQR", (0, 1.5)) == (0.0, 1.5) and delay_range("LQR", 2) == (2.0, 2.0)
    for bad in (-1, (1, 0), "late", float("nan"), (0, 1, 2), 1e9):
        with pytest.raises(ValueError, match=r"LQR\.delay"):
            delay_range("LQR", bad)

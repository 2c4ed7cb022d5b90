"""The target against bounded least squares of SciPy, and against every face of the inputs' box tried in turn."""

import itertools

import numpy as np
import pytest
from elastic_hub import DT, HELD, K2, LINK, POINT, C, Q, R, moved, roll
from scipy.optimize import lsq_linear

from pliant.controllers import MPC
from pliant.controllers.mpc.steady_target import Target

NX = 4


def case(seed, nu, tracked, units=1.0):
    """A random stable model, its cost, limits and tracked signals; `units` scales the inputs."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(NX, NX))
    A *= 0.8 / np.abs(np.linalg.eigvals(A)).max()
    B = rng.normal(size=(NX, nu)) / units
    H, D = rng.normal(size=(tracked, NX)), rng.normal(size=(tracked, nu)) / units
    weight = np.diag(np.concatenate([rng.uniform(0.1, 1.0, NX), rng.uniform(0.1, 1.0, nu) / units**2]))
    low, high = -rng.uniform(0.5, 1.5, nu) * units, rng.uniform(0.5, 1.5, nu) * units
    target = Target(A, B, np.zeros((NX, 0)), (H, D, np.zeros((tracked, 0))), weight, low, high)
    G = np.linalg.solve(np.eye(NX) - A, B)  # x = G u at rest
    return target, G, H @ G + D, weight, low, high


def faces(gain, r, cost, low, high):
    """The least u'cost u with gain u = r and low <= u <= high: equality-constrained optima of every face."""
    best, found = np.inf, None
    nu = len(low)
    for face in itertools.product((-1, 0, 1), repeat=nu):
        free = [i for i in range(nu) if not face[i]]
        u = np.where(np.array(face) < 0, low, high)
        u[free] = 0.0
        if len(free) < len(r):
            continue
        C, g = cost[np.ix_(free, free)], gain[:, free]
        K = np.block([[C, g.T], [g, np.zeros((len(r), len(r)))]])
        u[free] = np.linalg.solve(K, np.concatenate([-cost[free] @ u, r - gain @ u]))[: len(free)]
        if (u >= low - 1e-9).all() and (u <= high + 1e-9).all() and u @ cost @ u < best:
            best, found = u @ cost @ u, u
    return found


@pytest.mark.parametrize("units", [1.0, 1e9, 1e-9])
@pytest.mark.parametrize("seed", range(8))
def test_beyond_reach_the_error_is_the_least_that_the_limits_allow(seed, units):
    target, G, gain, _, low, high = case(seed, 2, 1, units)
    r = np.array([1.01 * np.abs(gain[0]) @ np.maximum(high, -low)])
    s = target(np.zeros(0), r)
    least = lsq_linear(gain * units, r, (low / units, high / units), tol=1e-14)
    assert target.missed and target.limited
    assert abs(gain @ s[NX:] - r)[0] == pytest.approx(np.sqrt(2 * least.cost), rel=1e-6)
    np.testing.assert_allclose(s[:NX], G @ s[NX:], atol=1e-9 * np.abs(s[:NX]).max())


@pytest.mark.parametrize("seed", range(8))
def test_two_signals_that_cannot_both_be_had_share_the_error_by_their_ranges(seed):
    target, _, gain, _, low, high = case(seed, 2, 2)
    spread = np.abs(gain) @ (high - low) / 2  # half of the range of each
    r = gain @ ((high + low) / 2) + 1.2 * spread  # past the reach of each
    s = target(np.zeros(0), r)
    least = lsq_linear(gain / spread[:, None], r / spread, (low, high), tol=1e-14)
    assert target.missed
    assert np.square((gain @ s[NX:] - r) / spread).sum() == pytest.approx(2 * least.cost, rel=1e-6)


@pytest.mark.parametrize("units", [1.0, 1e9, 1e-9])
@pytest.mark.parametrize("seed", range(12))
def test_a_goal_within_reach_is_met_exactly_though_an_input_is_at_its_limit(seed, units):
    target, G, gain, weight, low, high = case(seed, 3, 1, units)
    ends = np.where(gain[0] > 0, high, low)
    r = np.array([0.95 * gain[0] @ ends])
    s = target(np.zeros(0), r)
    u = s[NX:]
    assert (u >= low - 1e-9 * units).all() and (u <= high + 1e-9 * units).all()
    assert gain[0] @ u == pytest.approx(r[0], rel=1e-8) and not target.missed
    both = np.vstack([G, np.eye(3)]) * units
    best = faces(gain * units, r, both.T @ weight @ both, low / units, high / units)
    np.testing.assert_allclose(u / units, best, atol=1e-5)


def test_a_target_past_the_limits_is_met_as_nearly_as_they_allow():
    """The piezo alone bends the link at rest: half the wanted bend is what its limit of 1 allows."""
    most = -np.linalg.solve(K2[1:, 1:], [[-0.5]])[0, 0]
    free = MPC.design(LINK, Q, R, dt=DT, limits=(-1.0, 1.0), track=("theta", "bend"))
    free.aim({"theta": 0.0, "bend": 2 * most})
    xs, _ = roll(free, np.zeros(4), 400)
    np.testing.assert_allclose(xs[-1][:2], [0.0, most], atol=1e-5)
    assert free.record.unreached == 400


def test_aim_is_a_value_of_the_signal_also_about_a_point_that_is_not_zero():
    options = {"dt": DT, "horizon": 10, "track": ("tip",)}
    there = MPC.design(moved(LINK), Q, R, limits=(HELD - 3.0, HELD + 3.0), **options)
    assert there.tracked == {"tip": pytest.approx(0.7)}
    there.aim({"tip": 1.1})
    sampled, x = LINK.discretize(DT), np.zeros(4)
    for k in range(600):
        x = sampled.A @ x + sampled.B @ (there.act(k * DT, POINT + x) - HELD)
    assert C[0] @ (POINT + x) == pytest.approx(1.1, abs=1e-6)

"""Verdicts over a nominal that ends: closed forms, and what is said where numbers are rounding."""

import numpy as np
import pytest
from known_systems import ltv

from pliant.plants.stability import assess
from pliant.plants.stability.open_motion import ends_within
from pliant.plants.transitions.state_matrix_path import as_pieces, paths_of
from pliant.plants.transitions.transition_error import transition


def slow_beside_fast(T=2.0):
    """A pendulum of 1 rad/s whose speed is felt by an angle that nothing feels, coupled to a mode of 300 rad/s."""
    t = np.linspace(0.0, T, 401)
    A = np.zeros((401, 5, 5))  # drifting angle; pendulum angle, its rate; mode, its rate
    A[:, 0, 2] = 1.0
    A[:, 1, 2], A[:, 2, 1] = 1.0, -1.0 - 0.1 * np.sin(t)
    A[:, 2, 3], A[:, 4, 1] = 2e3, 1e2
    A[:, 3, 4], A[:, 4, 3], A[:, 4, 4] = 1.0, -(300.0**2), -60.0
    return ltv(t, A)


def test_drift_is_told_in_units_of_the_motion_and_not_of_its_fastest_mode():
    """Where all are measured by the fast mode the pendulum's speed counts a hundredth: it seems to grow."""
    told = assess(slow_beside_fast(), periodic=False)
    assert told.evidence["growth"].total > 10
    assert (told.verdict, told.drifting) == ("drift", ("x0",))
    assert "states weighed alike" in told.sentence


def test_what_drifts_is_not_made_small_by_its_unit():
    """Three integrators, the first left out: the second grows by T all the same."""
    t = np.linspace(0.0, 100.0, 201)
    A = np.zeros((201, 4, 4))
    A[:, 0, 1] = A[:, 1, 2] = 1.0
    A[:, 3, 3] = -1 - 0.1 * np.sin(t)
    moved = transition(*paths_of(as_pieces(ltv(t, A)), None), 1e-6)
    assert ends_within(moved, [1, 2, 3]) == pytest.approx((100 + np.sqrt(100**2 + 4)) / 2, rel=1e-6)
    assert assess(ltv(t, A), periodic=False).verdict == "undecided"
    assert ends_within(None) == np.inf


def test_unevenly_spaced_nodes_do_not_make_a_power_an_exponential():
    """x' = 2/(1 + t) x: (1 + t)^2, on nodes each a few per cent later than the one before."""
    t = np.r_[0.0, np.geomspace(1e-3, 500.0, 600)]
    told = assess(ltv(t, (2 / (1 + t))[:, None, None]), periodic=False)
    assert told.evidence["growth"].total == pytest.approx(501.0**2, rel=1e-4)
    assert told.verdict == "undecided" and not told.evidence["growth"].compounds


def test_no_certificate_is_sought_where_some_deviation_ends_larger():
    told = assess(slow_beside_fast(), periodic=False)
    assert "lyapunov" not in told.evidence and "ends as large as it began" in told.reasons["lyapunov"]


def test_numbers_that_are_rounding_are_told_as_such():
    """A double root at zero is off by the root of the rounding; two modes of which one is undamped."""
    A = np.zeros((4, 4))
    A[0, 1], A[2, 3], A[3, 2] = 1.0, 1.0, -9.0
    still = assess(ltv(np.array([0.0, 1.0]), np.repeat(A[None], 2, axis=0)).at(0))
    assert still.verdict == "marginal" and "but by rounding" in still.why and "to within 0" not in still.why
    t = np.linspace(0.0, 4.0, 200)
    moving = np.repeat(A[None], 200, axis=0)
    moving[:, 3, 2] -= np.sin(t)
    Q = np.linalg.qr(np.random.default_rng(3).normal(size=(4, 4)))[0]
    told = assess(ltv(t, Q @ moving @ Q.T), periodic=False)
    assert "0 but for rounding" in told.reasons["frozen_time"] and "suggests marginal" in told.reasons["frozen_time"]
    assert "but for rounding" in told.reasons["slow_variation"] and not told.critical_times


def test_a_root_that_leaves_zero_at_the_start_has_no_critical_time_there():
    """Stiffness that falls from zero: growth begins with the motion and not at 1e-9 s."""
    t = np.linspace(0.0, 2.0, 201)
    A = np.zeros((201, 2, 2))
    A[:, 0, 1], A[:, 1, 0] = 1.0, t
    assert min(assess(ltv(t, A), periodic=False).critical_times, default=1.0) > 0.01


def test_a_decay_by_slow_variation_says_that_deviations_end_larger():
    """Far from normal and slow to change: on so short a record they have grown, and the roots are believed all the
    same."""
    t = np.linspace(0.0, 1.0, 201)
    A = np.repeat(np.array([[-1.0, 8.0, 0.0], [0.0, -1.0, 8.0], [0.0, 0.0, -1.0]])[None], 201, axis=0)
    A[:, 0, 0] -= 1e-3 * np.sin(t)
    told = assess(ltv(t, A), periodic=False)
    assert (told.verdict, told.method) == ("stable", "slow_variation") and told.evidence["growth"].total > 1
    assert "times as large as they began" in told.sentence


def test_slow_variation_that_the_nodes_do_not_show_leaves_it_to_growth():
    """9 nodes and modes of up to 150 1/s: slow as A looks, but what may be between its nodes is more than the decay."""
    rng, t = np.random.default_rng(7), np.arange(9) / 8.0
    first, second = (np.round(rng.standard_normal((3, 3)) * 16) * 2.5 for _ in range(2))
    A = first + (t * (1.0 - t))[:, None, None] * second / 4 - 8.0 * np.eye(3)
    quick = assess(ltv(t, A), periodic=False, thorough=False)
    assert quick.evidence["slow_variation"] and quick.verdict == assess(ltv(t, A), periodic=False).verdict

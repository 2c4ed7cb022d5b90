"""Frozen-time eigenvalues are wrong in both directions, and the verdict is not taken in."""

import numpy as np
import pytest
from scipy.linalg import expm

from pliant.plants import LTVModel
from pliant.plants.stability import assess, floquet, frozen_time, growth, lyapunov, slow_variation


def turning(N, rate, turns=1.0, nodes=257):
    """A(t) = R(t) N R(t)^T with R a rotation at `rate`; in the turning frame z' = (N - rate J) z is constant."""
    t = np.linspace(0.0, turns * np.pi / abs(rate), nodes)  # A has the period of half a turn
    c, s = np.cos(rate * t), np.sin(rate * t)
    R = np.array([[c, -s], [s, c]]).transpose(2, 0, 1)
    A = R @ N @ R.transpose(0, 2, 1)
    zero = {
        k: np.zeros((nodes, *s)) for k, s in {"B": (2, 0), "E": (2, 0), "C": (0, 2), "D": (0, 0), "F": (0, 0)}.items()
    }
    rows = {"c": np.zeros((nodes, 2)), "x": np.zeros((nodes, 2)), "u": np.zeros((nodes, 0)), "y": np.zeros((nodes, 0))}
    return LTVModel(t, A, **zero, **rows, states=("x1", "x2"), inputs=(), disturbances=(), outputs=())


J = np.array([[0.0, -1.0], [1.0, 0.0]])
# Markus and Yamabe's matrix -1 + 1.5 cos^2 t, 1 - 1.5 sin t cos t; -1 - 1.5 sin t cos t, -1 + 1.5 sin^2 t at t = 0;
# roots (-1 +- i sqrt 7)/4 at all times and the growing solution e^(t/2) (-cos t, sin t). It turns clockwise.
MARKUS = np.array([[0.5, 1.0], [-1.0, -1.0]])
# The other way round: a frozen root of +1 at all times, and yet both solutions decay (Wu 1974's kind).
WU = np.array([[1.0, 0.0], [0.0, -4.0]])


def test_stable_at_every_time_and_unstable():
    model = turning(MARKUS, -1.0)
    frozen = frozen_time(model)
    np.testing.assert_allclose(frozen.eigenvalues.real, -0.25, atol=1e-12)
    np.testing.assert_allclose(np.abs(frozen.eigenvalues.imag), np.sqrt(7) / 4, atol=1e-12)
    found = floquet(model)
    np.testing.assert_allclose(np.sort(np.abs(found.multipliers)), np.exp([-np.pi, np.pi / 2]), rtol=1e-9)
    assert found.growth == pytest.approx(0.5, abs=1e-10)
    verdict = assess(model)
    assert (verdict.verdict, verdict.method) == ("unstable", "floquet")
    assert verdict.margin == pytest.approx(-0.5, abs=1e-10)
    assert verdict.evidence["frozen_time"].suggests == "stable"
    slow = slow_variation(model)
    assert not slow.allowed and slow.used > 1 and slow.inside < 0 and slow.rate > slow.bound
    assert not lyapunov(model)
    assert growth(model).total == pytest.approx(np.exp(np.pi / 2), rel=1e-6)


def test_unstable_at_every_time_and_stable():
    rate = 3.0
    wanted = np.linalg.eigvals(WU - rate * J).real.max()
    assert wanted < 0
    model = turning(WU, rate)
    frozen = frozen_time(model)
    np.testing.assert_allclose(frozen.rightmost, 1.0, atol=1e-12)
    assert frozen.suggests == "unstable"
    verdict = assess(model)
    assert (verdict.verdict, verdict.method) == ("stable", "floquet")
    assert verdict.margin == pytest.approx(-wanted, rel=1e-8)
    assert "suggests unstable" in verdict.reasons["frozen_time"]
    certificate = lyapunov(model)
    assert certificate and 0 < certificate.alpha < -wanted
    half_turn = expm((WU - rate * J) * np.pi / rate)
    np.testing.assert_allclose(
        np.sort_complex(-floquet(model).multipliers), np.sort_complex(np.linalg.eigvals(half_turn)), atol=1e-9
    )


def test_the_same_without_periodicity_is_decided_by_other_methods():
    """Just short of closing, Floquet is out: growth finds the unstable one, a certificate the stable one."""
    grows = assess(turning(MARKUS, -1.0, turns=1.93))
    assert (grows.verdict, grows.method) == ("unstable", "growth")
    decays = assess(turning(WU, 3.0, turns=1.93))
    assert decays.verdict == "stable" and decays.method in ("lyapunov", "growth")
    for verdict in (grows, decays):
        assert "periodic" in verdict.reasons["floquet"]
        assert "not to be believed" in verdict.reasons["frozen_time"]


def test_turning_slowly_enough_the_frozen_roots_may_be_believed():
    model = turning(np.array([[-1.0, 2.0], [-0.5, -1.0]]), 0.05, turns=0.4)
    slow = slow_variation(model)
    assert slow and 0 < slow.used < 1
    exact = -np.linalg.eigvals(np.array([[-1.0, 2.0], [-0.5, -1.0]]) - 0.05 * J).real.max()
    assert 0 < slow.decay < exact
    verdict = assess(model)
    assert (verdict.verdict, verdict.method) == ("stable", "slow_variation")
    assert 0 < verdict.margin < exact

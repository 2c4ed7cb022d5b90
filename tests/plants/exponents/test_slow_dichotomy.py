"""Slow variation that decides both ways, held against rotating frames whose exponents are closed forms."""

from functools import reduce

import numpy as np
import pytest

from pliant.plants.exponents import slow_dichotomy

T = np.linspace(0.0, 30.0, 301)
SKEW = 1.0  # ln of what the coordinates of the test may be away from the states, here
J = np.array([[0.0, -1.0], [1.0, 0.0]])


def rotating(along, turn, A0, w):
    """A = R(w t)' A0 R(w t): in y = R x, dy/dt = (A0 + w J) y."""
    return along(T, lambda t: turn(w * t).T @ A0 @ turn(w * t)), np.linalg.eigvals(A0 + w * J).real.max()


def test_an_unstable_frame_that_turns_slowly_is_unstable(along, turn):
    model, truth = rotating(along, turn, np.array([[0.2, 1.0], [0.0, -1.0]]), 0.03)
    found = slow_dichotomy(model)
    assert found.verdict == "unstable" and found.growing == 1
    assert 0 < found.rate <= truth


def test_a_stable_frame_that_turns_slowly_is_stable(along, turn):
    model, truth = rotating(along, turn, np.array([[-0.4, 1.0], [0.0, -1.0]]), -0.05)
    found = slow_dichotomy(model)
    assert found.verdict == "stable" and found.growing == 0
    assert truth <= found.rate < 0


@pytest.mark.parametrize("w", [-3.0, 3.0])
def test_nothing_is_said_where_the_frame_turns_fast(along, turn, w):
    """All roots at -1 +- ..; the frame makes it grow where it turns one way (Markus and Yamabe)."""
    model, _ = rotating(along, turn, np.array([[-1.0, -5.0], [0.0, -1.1]]), w)
    assert not slow_dichotomy(model)


def test_a_constant_model_is_its_roots(still):
    found = slow_dichotomy(still([[0.3, 2.0], [0.0, -1.0]]))
    assert found.verdict == "unstable" and found.rate == pytest.approx(0.3, abs=1e-6) and found.used < 1e-9
    assert slow_dichotomy(still([[-0.3, 2.0], [0.0, -1.0]])).rate == pytest.approx(-0.3, abs=1e-6)
    shifted = slow_dichotomy(still([[-0.3, 2.0], [0.0, -1.0]]), shift=-0.5)
    assert shifted.growing == 1 and shifted.verdict == "undecided"  # one decays slower than 0.5 1/s, neither grows


def test_roots_with_no_side_are_refused(still, along):
    assert "real part" in slow_dichotomy(still([[0.0, 1.0], [0.0, -1.0]])).why
    assert "cross" in slow_dichotomy(along(T, lambda t: np.diag([t - 15.03, -20.0]))).why


def test_growth_that_is_proved_is_there(along):
    """Random slow models: the largest singular value over the record is at least what V proves."""
    shown = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        M, N = rng.standard_normal((2, 3, 3))
        model = along(np.linspace(0, 10, 201), lambda t, M=M, N=N: M + 0.1 * np.sin(0.3 * t) * N)
        found = slow_dichotomy(model)
        if found.verdict == "unstable":
            Phi = reduce(lambda total, step: step @ total, model.transition()[0])
            shown += 1
            assert np.log(np.linalg.norm(Phi, 2)) / 10 >= found.rate - abs(found.overshoot) / 10 - SKEW / 10
    assert shown >= 6


def test_wrong_numbers_are_refused(still):
    with pytest.raises(ValueError, match="shift"):
        slow_dichotomy(still([[-1.0]]), shift=np.nan)
    with pytest.raises(ValueError, match="samples"):
        slow_dichotomy(still([[-1.0]]), samples=1)


def test_what_the_motion_of_a_eats(along):
    """Scalar a = 1 + t/2: H = 1/(2 a), dH/dt = -a'/(2 a^2), so that the share is a'/(2 a^2), a quarter at the start."""
    found = slow_dichotomy(along(np.linspace(0, 2, 201), lambda t: np.array([[1 + t / 2]])))
    assert found.used == pytest.approx(0.25, rel=0.02) and found.verdict == "unstable"

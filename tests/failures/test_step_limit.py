"""A fixed explicit step past the fastest mode's limit diverges; Pliant refuses it and says which step is safe."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import DOP853

from pliant.plants import StabilityLimitError, TwoLinkArm, step_limit

ARM = dataclasses.replace(TwoLinkArm.textbook(), hub_inertia=(0.1, 0.02), basis="polynomial", modes=(3, 3))
X0, U0 = ARM.equilibrium(theta1=-1.2, theta2=0.4)
START = X0 + np.concatenate([np.zeros(8), [0.1, -0.2], np.zeros(6)])
TIMES = np.linspace(0, 0.5, 26)


RK4 = np.diag([0.5, 0.5, 1.0], -1), np.array([1, 2, 2, 1]) / 6
RK8 = DOP853.A[:12, :12], DOP853.B
TABLEAUS = {"rk4": RK4, "rk8": RK8}


def by_hand(method, step):
    """An explicit Runge-Kutta method with no check at all; the largest energy on the way [J]."""
    A, b = TABLEAUS[method]
    x, largest = START, abs(ARM.energy(START))
    for _ in range(round(0.5 / step)):
        k = np.zeros((len(b), len(x)))
        for i in range(len(b)):
            k[i] = ARM.dynamics(x + step * A[i] @ k, U0)
        x = x + step * b @ k
        largest = max(largest, abs(ARM.energy(x)))
        if largest > 1e4:
            break
    return largest


@pytest.mark.parametrize("method", ["rk4", "rk8"])
def test_past_its_limit_it_diverges_and_just_inside_it_does_not(method):
    limit = step_limit(ARM, START, method)
    assert by_hand(method, 1.05 * limit) > 1e4
    assert by_hand(method, 0.95 * limit) == pytest.approx(abs(ARM.energy(START)), rel=0.02)


@pytest.mark.parametrize("method", ["rk4", "rk8"])
def test_pliant_refuses_the_step_and_names_the_mode_and_the_safe_step(method):
    limit = step_limit(ARM, START, method)
    fastest = ARM.natural_frequencies(X0).max()
    with pytest.raises(StabilityLimitError, match=rf"{method} .*its mode at \S+ Hz .*rosenbrock") as caught:
        ARM.simulate(START, U0, 1.05 * limit * np.arange(100), method=method, step=1.05 * limit)
    assert caught.value.largest_step == pytest.approx(limit)
    assert abs(caught.value.mode) == pytest.approx(fastest, rel=0.01)


def test_the_recommended_ways_hold():
    limit = step_limit(ARM, START)
    exact = ARM.simulate(START, U0, TIMES)
    for method, step in (("rk4", 0.5 * limit), ("rk8", limit)):
        within = ARM.simulate(START, U0, TIMES, method=method, step=step)
        assert np.abs(within["tip_y"] - exact["tip_y"]).max() < 1e-4
    for method in ("rosenbrock", "midpoint"):
        motion = ARM.simulate(START, U0, TIMES, method=method, step=2 * limit)
        assert np.abs(motion["tip_y"] - exact["tip_y"]).max() < 1e-2

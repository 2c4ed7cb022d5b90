"""A fixed RK4 step past the fastest mode's limit diverges; Pliant refuses it and says which step is safe."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import StabilityLimitError, TwoLinkArm, step_limit

ARM = dataclasses.replace(TwoLinkArm.textbook(), hub_inertia=(0.1, 0.02), basis="polynomial", modes=(3, 3))
X0, U0 = ARM.equilibrium(theta1=-1.2, theta2=0.4)
START = X0 + np.concatenate([np.zeros(8), [0.1, -0.2], np.zeros(6)])
TIMES = np.linspace(0, 0.5, 26)


def by_hand(step):
    """Classical RK4 with no check at all; the largest energy on the way [J]."""
    x, largest = START, abs(ARM.energy(START))
    for _ in range(round(0.5 / step)):
        k1 = ARM.dynamics(x, U0)
        k2 = ARM.dynamics(x + step / 2 * k1, U0)
        k3 = ARM.dynamics(x + step / 2 * k2, U0)
        k4 = ARM.dynamics(x + step * k3, U0)
        x = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        largest = max(largest, abs(ARM.energy(x)))
        if largest > 1e6:
            break
    return largest


def test_rk4_past_its_limit_diverges_and_just_inside_it_does_not():
    limit = step_limit(ARM, START)
    assert by_hand(1.05 * limit) > 1e6
    assert by_hand(0.95 * limit) == pytest.approx(abs(ARM.energy(START)), rel=0.02)


def test_pliant_refuses_the_step_and_names_the_mode_and_the_safe_step():
    limit = step_limit(ARM, START)
    fastest = ARM.natural_frequencies(X0).max()
    with pytest.raises(StabilityLimitError, match=r"its mode at \S+ Hz .*rosenbrock") as caught:
        ARM.simulate(START, U0, 1.05 * limit * np.arange(100), method="rk4", step=1.05 * limit)
    assert caught.value.largest_step == pytest.approx(limit)
    assert abs(caught.value.mode) == pytest.approx(fastest, rel=0.01)


def test_the_recommended_ways_hold():
    limit = step_limit(ARM, START)
    exact = ARM.simulate(START, U0, TIMES)
    within = ARM.simulate(START, U0, TIMES, method="rk4", step=0.5 * limit)
    assert np.abs(within["tip_y"] - exact["tip_y"]).max() < 1e-4
    for method in ("rosenbrock", "midpoint"):
        motion = ARM.simulate(START, U0, TIMES, method=method, step=2 * limit)
        assert np.abs(motion["tip_y"] - exact["tip_y"]).max() < 1e-2

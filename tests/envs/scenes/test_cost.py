"""What a scene charges, by hand."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import Trajectory


def test_cost_of_a_constant_motion_by_hand() -> None:
    """Held at x with a constant torque: duration times the weighted squares."""
    scene = scenes.get("single-link-slew")
    t = scene.times
    x = np.zeros((len(t), scene.plant.nx))
    x[:, 0], x[:, 3] = 0.4, 0.5  # hub angle and its rate
    u = np.full((len(t), 1), 7.0)
    motion = Trajectory.from_arrays(t, x, u, plant=scene.plant)
    by_hand = 3.0 * (10.0 * 0.6**2 + 0.1 * 0.5**2 + 2e-3 * 7.0**2)
    assert scene.cost(motion) == pytest.approx(by_hand, rel=1e-12)


def test_early_end_rate_by_hand() -> None:
    """Unbounded angle at its start and spread, bounded signals at their bounds, the torque at its limit."""
    by_hand = 10.0 * 1.1**2 + 0.1 * 12.0**2 + 100.0 * 0.3**2 + 0.1 * 0.0 + 2e-3 * 40.0**2
    assert scenes.get("single-link-slew").early_end_rate == pytest.approx(by_hand, rel=1e-12)

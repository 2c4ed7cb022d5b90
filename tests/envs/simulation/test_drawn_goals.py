"""References of other goals: the scene's own where nothing is off; refused where a goal is no rest point."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.simulation.control_period import reference
from pliant.envs.simulation.drawn_goals import allowed_offsets, goal_references


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach"])
def test_no_offset_gives_the_scenes_own(name: str) -> None:
    scene = scenes.get(name)
    found = goal_references(scene, np.zeros((2, len(scene.goal))))
    np.testing.assert_allclose(found, np.tile(reference(scene), (2, 1)), atol=1e-8)


def test_goals_that_move_are_refused() -> None:
    spin = scenes.get("spin-up")
    with pytest.raises(ValueError, match="goal_spread must be 0"):
        goal_references(spin, np.zeros((1, len(spin.goal))))


def test_attitudes_are_drawn_as_unit_quaternions() -> None:
    """Off by (0, 0.1, 0, 0) of no turn: a turn of tangent 0.1 of half its angle, which the attitude's output shows."""
    slew = scenes.get("spacecraft-slew")
    found = allowed_offsets(slew, np.array([[0.0, 0.1, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]))
    half = np.arctan(0.1)
    np.testing.assert_allclose(found, [[np.cos(half) - 1, np.sin(half), 0, 0], [0, 0, 0, 0]], atol=1e-15)
    turned, own = goal_references(slew, found)
    x = slew.target[0].copy()
    x[:4] = np.cos(half), np.sin(half), 0.0, 0.0
    want = slew.signal_values(x, slew.plant.measure(x), slew.observe)
    np.testing.assert_allclose(turned[: len(want)], want, atol=1e-9)
    np.testing.assert_allclose(own, reference(slew), atol=1e-9)
    arm = scenes.get("two-link-reach")
    assert np.array_equal(allowed_offsets(arm, np.ones((1, 2))), np.ones((1, 2)))

"""Actions about the input midway between what holds the start and what holds the goal."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.scenes import registry
from pliant.envs.tasks import Task, actions, shares

ARMS = ("single-link-slew", "two-link-reach", "two-link-reach-weak", "three-link-flexible", "flexible-joint-slew")


@pytest.mark.parametrize("name", ARMS)
def test_start_and_goal_are_held_by_actions_inside_of_the_range(name):
    assert name in (*registry.names(), *registry.VARIANTS)
    scene = scenes.get(name)
    m, r = actions.midway(scene)
    for _, u in (scene.initial, scene.target):
        held = (u / np.array(scene.limits) - m) / r
        assert (np.abs(held) <= 1 / actions.MORE + 1e-12).all()
        np.testing.assert_allclose(shares(scene, "midway", held), u / np.array(scene.limits), atol=1e-12)


def test_where_nothing_pulls_half_of_the_limits_is_asked_for():
    scene = scenes.get("single-link-slew")
    np.testing.assert_allclose(shares(scene, "midway", np.array([[-7.0], [0.0], [1.0]])), [[-0.5], [0.0], [0.5]])


def test_nominal_actions_reach_what_the_motion_takes():
    """spin-up turns with at most 2 * 6 / 15 = 0.8 rad/s^2 of 2; six-axis-pick by what its nominal inputs are."""
    m, r = actions.placed(scenes.get("spin-up"), "nominal")
    np.testing.assert_allclose([m, r], [[0.0], [1.25 * 0.8 / 2.0]], rtol=1e-3)  # at control times
    scene = scenes.get("six-axis-pick")
    limits, (m, r) = np.array(scene.limits), actions.placed(scene, "nominal")
    np.testing.assert_allclose(m, (scene.initial[1] + scene.target[1]) / limits / 2, rtol=0, atol=1e-12)
    asked = np.array([scene.nominal_input(t) for t in scene.times]) / limits - m
    held = np.abs(scene.initial[1] / limits - m)  # as much again is left for
    np.testing.assert_allclose(r, np.maximum(1.25 * np.abs(asked).max(axis=0), 1.5 * held), rtol=1e-9)
    assert np.isclose(r, 1.5 * held).tolist() == [False, True, True, False, False, False]
    np.testing.assert_allclose(shares(scene, "nominal", np.array([[-7.0] * 6, [0.5] * 6])), [m - r, m + r / 2])


def test_what_is_let_go_or_nowhere_driven_is_reached_as_midway():
    for name in ("crane-swing", "cantilever-drop"):
        scene = scenes.get(name)
        (_, half), (_, r) = actions.midway(scene), actions.placed(scene, "nominal")
        asked = (
            np.array([scene.nominal_input(t) for t in scene.times]) / np.array(scene.limits) - actions.midway(scene)[0]
        )
        still = np.abs(asked).max(axis=0) < 1e-9
        assert still.any() == (name == "cantilever-drop")
        np.testing.assert_array_equal(r[still], half[still])


def test_as_shares_of_the_limits_they_pass():
    given = np.array([[3.0, -0.2]])
    assert shares(scenes.get("two-link-reach"), "limits", given) is given


def test_the_environment_plays_the_shares():
    scene = scenes.get("two-link-reach")
    own, plain = scene.vector_env(2, actions="midway"), scene.vector_env(2)
    given = np.array([[0.3, -0.9], [1.0, 0.2]])
    for env in (own, plain):
        env.reset(seed=0)
    one, other = own.step(given), plain.step(shares(scene, "midway", given))
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_array_equal(one[1], other[1])


def test_bad_input():
    with pytest.raises(ValueError, match=r"Task.actions = 'torque' must be one of"):
        Task(actions="torque")
    with pytest.raises(ValueError, match=r"Task\.hold = 0 must be an integer"):
        Task(hold=0)

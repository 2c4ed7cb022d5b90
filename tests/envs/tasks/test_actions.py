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

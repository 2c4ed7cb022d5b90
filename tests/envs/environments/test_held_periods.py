"""Actions that are held over several control periods, against the same actions given period by period."""

import gymnasium
import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.environments import PlantVectorEnv

HOLD, LANES = 4, 6
SCENE = "single-link-slew-gentle"  # its tip may bend by 10 mm: lanes end at different periods


def played(actions, **task):
    """(states, rewards, over) by period of actions given period by period, lanes waiting once over."""
    env = scenes.get(SCENE).vector_env(LANES, autoreset_mode="Disabled", **task)
    env.reset(seed=0)
    over, found = np.zeros(LANES, bool), []
    for k, row in enumerate(np.repeat(actions, HOLD, axis=0)):
        if k >= env.scene.steps or over.all():
            break
        env._over[:] = False  # lanes that are over go on here, and count no more
        _, reward, terminated, truncated, _ = env.step(row)
        found.append((env.states, np.where(over, 0.0, reward), over.copy()))
        over = over | terminated | truncated
    return [np.array(part) for part in zip(*found)]


def actions(rng=0):
    return np.random.default_rng(rng).uniform(-1, 1, (5, LANES, 1)) * np.linspace(0.02, 0.9, LANES)[:, None]


@pytest.mark.parametrize("reward", ["cost", "normalised"])
def test_held_actions_are_the_same_actions_period_by_period(reward):
    given = actions()
    states, rewards, over = played(given, reward=reward)
    env = scenes.get(SCENE).vector_env(LANES, autoreset_mode="Disabled", hold=HOLD, reward=reward)
    env.reset(seed=0)
    ended = np.zeros(LANES, bool)
    for k, row in enumerate(given):
        mask = ended.copy()
        env._over[:] = False
        _, reward_k, terminated, truncated, told = env.step(row)
        part = slice(k * HOLD, (k + 1) * HOLD)
        want = rewards[part].sum(axis=0) / (HOLD if reward == "normalised" else 1)
        np.testing.assert_allclose(reward_k[~mask], want[~mask], rtol=1e-12)
        for lane in np.flatnonzero(~mask):
            periods = np.flatnonzero(~over[part, lane])
            np.testing.assert_array_equal(env.states[lane], states[k * HOLD + periods[-1], lane])
            assert env.times[lane] == pytest.approx((k * HOLD + periods[-1] + 1) * env.scene.dt)
        if reward == "cost" and (now := terminated & ~mask).any():
            np.testing.assert_allclose(told["cost"][now], -want[now], rtol=1e-12)
        ended |= terminated | truncated
    assert ended.any() and not ended.all()  # some lane ended within an action, some did not


def test_the_single_environment_plays_as_a_lane_does():
    given = actions(1)[:, -2:-1]
    options = {"hold": HOLD, "terms": True, "reward": "normalised", "history": 1, "action_delay": 1}
    lane = scenes.get(SCENE).vector_env(1, **options)
    own = gymnasium.make("pliant/SingleLinkSlewGentle-v0", **options)
    assert np.array_equal(lane.reset(seed=3)[0][0], own.reset(seed=3)[0])
    for row in given:
        many, one = lane.step(row), own.step(row[0])
        np.testing.assert_allclose(one[0], many[0][0], rtol=1e-12)
        assert one[1] == pytest.approx(many[1][0], rel=1e-12)
        assert one[2:4] == (many[2][0], many[3][0])
        for name, value in one[4]["reward_terms"].items():
            assert value == pytest.approx(many[4]["reward_terms"][name][0], rel=1e-9, abs=1e-15)
        if one[2]:
            break
    assert one[2]


def test_lanes_start_again_at_once_and_the_last_reading_is_that_of_the_end():
    env = scenes.get(SCENE).vector_env(1, hold=HOLD, autoreset_mode="SameStep")
    first, _ = env.reset(seed=0)
    obs, _, terminated, _, told = env.step(np.ones((1, 1)))
    assert terminated[0]
    np.testing.assert_array_equal(obs, first)
    ends = scenes.get(SCENE).vector_env(1, autoreset_mode="Disabled")
    ends.reset(seed=0)
    over = False
    while not over:
        last, _, ended, _, _ = ends.step(np.ones((1, 1)))
        over = bool(ended[0])
    np.testing.assert_array_equal(told["final_obs"][0], last[0])


def test_episodes_have_as_many_actions_as_fit():
    made = gymnasium.make("pliant/SingleLinkSlew-v0", hold=4)
    assert made.spec.max_episode_steps == 38  # 150 periods of the scene, the last action held over two
    made.reset(seed=0)
    ends = [made.step(np.zeros(1))[2:4] for _ in range(38)]
    assert ends[-1] == (False, True) and not any(b for _, b in ends[:-1])
    assert made.unwrapped.time == pytest.approx(3.0)
    short = scenes.get("single-link-slew").vector_env(1, hold=4, max_episode_steps=3)
    short.reset(seed=0)
    assert [bool(short.step(np.zeros((1, 1)))[3][0]) for _ in range(3)] == [False, False, True]
    with pytest.raises(
        ValueError, match="max_episode_steps = 39 must be an integer from 1 to 38, the actions of scene"
    ):
        scenes.get("single-link-slew").vector_env(1, hold=4, max_episode_steps=39)
    assert PlantVectorEnv("single-link-slew", 1, hold=5).metadata["render_fps"] == 10

"""Between policy and machine: the single environment and a lane agree bit for bit; delays, memory and goals by hand."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

FULL = {
    "sensors": True,
    "history": 2,
    "action_delay": (0, 3),
    "observation_delay": 1,
    "terms": True,
    "constraint": "cost",
    "reward": "normalised",
    "goal_spread": 0.2,
    "randomise": True,
}


@pytest.mark.parametrize("options", [FULL, {"difficulty": "hard", "history": 1, "dtype": "float32"}])
def test_a_lane_meets_what_the_single_environment_of_its_seed_meets(options) -> None:
    scene = scenes.get("single-link-slew", duration=0.2)
    single, lanes = PlantEnv(scene, **options), PlantVectorEnv(scene, 3, **options)
    a, _ = single.reset(seed=5)
    b, _ = lanes.reset(seed=4)
    assert np.array_equal(a, b[1]) and not np.array_equal(b[0], b[1])
    rng, over = np.random.default_rng(0), False
    for _ in range(80):  # beyond a chunk of noise
        actions = rng.uniform(-1.2, 1.2, (3, 1))
        told = None
        if over:
            a, _ = single.reset()
            reward, over, late = 0.0, False, False
        else:
            a, reward, over, late, told = single.step(actions[1])
        b, rewards, ended, cut, infos = lanes.step(actions)
        assert np.array_equal(a, b[1]) and (reward, over, late) == (rewards[1], ended[1], cut[1])
        if told is not None and options.get("terms"):
            terms = told["reward_terms"]
            assert terms == {name: infos["reward_terms"][name][1] for name in terms}
            assert sum(terms.values()) == pytest.approx(-told["cost"])
            assert told["cost_constraint"] == infos["cost_constraint"][1]
        over = over or late


def test_a_seed_gives_the_same_readings_again() -> None:
    env = PlantEnv("single-link-slew", noise=0.02, action_delay=(0, 2))
    first = [env.reset(seed=3)[0], *(env.step(np.zeros(1))[0] for _ in range(3))]
    again = [env.reset(seed=3)[0], *(env.step(np.zeros(1))[0] for _ in range(3))]
    assert np.array_equal(first, again)


def test_late_actions_and_readings() -> None:
    """An action that acts two periods late moves the plant as it does at once, two periods before."""
    plain, late, blind = (
        PlantEnv("single-link-slew", **o) for o in ({}, {"action_delay": 2}, {"observation_delay": 2})
    )
    for env in (plain, late, blind):
        env.reset(seed=0)
    first = plain.reset(seed=0)[0]
    push = np.full(1, 0.5)
    seen = [first] + [plain.step(push)[0] for _ in range(5)]
    idle = [late.step(push)[0] for _ in range(7)]
    np.testing.assert_allclose(idle[:2], [first] * 2, atol=1e-12)  # at rest, held
    np.testing.assert_allclose(idle[2:], seen[1:], rtol=1e-9, atol=1e-9)
    assert np.array_equal([blind.step(push)[0] for _ in range(5)], [first, first, *seen[1:4]])


def test_memory_is_newest_first_readings_then_actions() -> None:
    plain, env = PlantEnv("single-link-slew"), PlantEnv("single-link-slew", history=2)
    readings = [plain.reset(seed=0)[0]]
    obs, _ = env.reset(seed=0)
    assert np.array_equal(obs, np.concatenate([*readings * 3, [0.0, 0.0]]))
    for action in (0.1, 0.2, -0.3):
        readings.append(plain.step(np.array([action]))[0])
        obs = env.step(np.array([action]))[0]
    assert np.array_equal(obs, np.concatenate([readings[3], readings[2], readings[1], [-0.3, 0.2]]))


def test_a_drawn_goal_is_what_deviations_and_cost_are_measured_from() -> None:
    """At rest in the drawn goal nothing deviates and nothing is paid, gravity and sag included."""
    scene = scenes.get("two-link-reach")
    env = PlantEnv(scene, goal_spread=0.3)
    obs, _ = env.reset(seed=2)
    offset = obs[-2:]
    assert 0.01 < np.abs(offset).max() < 0.3
    goal = {name: value + d for (name, value), d in zip(scene.goal, offset)}
    x, u = scene.plant.equilibrium(goal)
    np.testing.assert_allclose(obs[:2], scene.initial[0][:2] - x[:2], atol=1e-9)
    obs, _ = env.reset(seed=2, options={"state": x})
    np.testing.assert_allclose(obs[:8], 0.0, atol=1e-6)
    _, reward, *_ = env.step(u / np.array(scene.limits))
    assert -1e-9 < reward <= 0.0

"""The units of reward="normalised": by hand, and alike in every environment."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.tasks.learning_units import GENTLE, LEAST, observation_scale

REACH = scenes.get("two-link-reach")
SLEW = scenes.get("single-link-slew")


def test_readings_are_over_what_the_nominal_motion_spans() -> None:
    scale = dict(zip(SLEW.observe, observation_scale(SLEW)))
    assert scale["hub_angle"] == pytest.approx(1.0, rel=1e-3)  # one radian, by a minimum-jerk motion ..
    assert scale["hub_angle_rate"] == pytest.approx(15.0 / 8.0 / SLEW.move_time, rel=0.05)  # .. of this peak rate
    scale = dict(zip(REACH.observe, observation_scale(REACH)))
    assert scale["theta1"] == pytest.approx(np.pi / 2 - 0.9, rel=0.2)
    assert scale["tip2_deflection"] >= LEAST * scale["tip1_deflection"]


@pytest.mark.parametrize("history", [0, 2])
def test_every_environment_shows_them(history) -> None:
    task = {"history": history, "goal_spread": 0.1 * bool(history)}
    own, learned = PlantEnv(SLEW, **task), PlantEnv(SLEW, reward="normalised", **task)
    lanes = SLEW.vector_env(2, reward="normalised", autoreset_mode="SameStep", max_episode_steps=3, **task)
    assert learned.action_space.high[0] == lanes.single_action_space.high[0] == 1.0 / GENTLE
    scale = lanes.observation_scale
    assert scale.shape == own.observation_space.shape and (scale[:4] == observation_scale(SLEW)).all()
    assert (scale[4:] == [*np.tile(scale[:4], 2), 1.0, 1.0, 1.0]).all() if history else len(scale) == 4
    raw, first, many = own.reset(seed=3)[0], learned.reset(seed=3)[0], lanes.reset(seed=3)[0]
    for k in range(3):
        np.testing.assert_allclose(first * scale, raw, rtol=1e-12)
        np.testing.assert_array_equal(many[0], first)
        action = np.array([0.3 + 0.2 * k])
        raw, first = own.step(GENTLE * action)[0], learned.step(action)[0]
        many, *_, infos = lanes.step(np.array([action, action]))
    np.testing.assert_array_equal(infos["final_obs"][0], first)
    np.testing.assert_allclose(first * scale, raw, rtol=1e-12)


def test_the_largest_action_is_the_limit() -> None:
    own, learned = PlantEnv(REACH), PlantEnv(REACH, reward="normalised")
    own.reset()
    learned.reset()
    own.step(np.array([1.0, -1.0]))
    learned.step(np.array([1.0, -1.0]) / GENTLE)
    np.testing.assert_array_equal(own.state, learned.state)

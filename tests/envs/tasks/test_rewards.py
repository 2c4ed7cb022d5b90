"""The bounded reward: its values by hand, its order, and that it is what environments give."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.tasks.rewards import KNEE, knee_cost, normalised

SLEW = scenes.get("single-link-slew")


def test_one_at_the_goal_a_third_at_the_start_zero_where_an_episode_ends() -> None:
    at_start = SLEW.dt * 10.0  # weight 10 of hub_angle, one radian off
    assert knee_cost(SLEW) == pytest.approx(at_start / KNEE)
    found = normalised(SLEW, np.array([0.0, at_start, np.inf, 0.0]), np.array([False, False, False, True]))
    assert found.tolist() == pytest.approx([1.0, 1.0 / 3.1972246, 0.0, 0.0])  # log 9 = 2.1972246


def test_every_environment_gives_it_and_ending_never_pays() -> None:
    short = scenes.get("single-link-slew", bounds=(("hub_angle_rate", 0.5),))
    single = PlantEnv(short, reward="normalised")
    lanes = short.vector_env(2, reward="normalised", autoreset_mode="SameStep")
    single.reset(seed=0)
    lanes.reset(seed=0)
    over = False
    while not over:
        _, reward, over, _, info = single.step(np.ones(1))
        _, rewards, _, _, infos = lanes.step(np.ones((2, 1)))
        assert rewards.tolist() == [reward] * 2
        cost = info["cost"] - info["early_end_cost"]
        assert reward == (0.0 if over else pytest.approx(1.0 / (1.0 + np.log(1.0 + cost / knee_cost(short)))))
    assert infos["cost"][0] == info["cost"] > 50.0  # what the scene charges is told as before


def test_a_start_that_costs_nothing_is_measured_by_the_charge_for_early_ends() -> None:
    still = scenes.get("single-link-slew", goal=(("hub_angle", 0.0),))
    assert knee_cost(still) == pytest.approx(still.dt * still.early_end_rate / KNEE)

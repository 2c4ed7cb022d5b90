"""Returns of simple policies."""

import json

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.studies.scene_pages.returns import returns, under_lqr

SCENE = scenes.get("single-link-slew")


def test_doing_nothing_returns_what_the_environment_pays() -> None:
    env = PlantEnv(SCENE)
    env.reset(seed=0)
    paid, over = 0.0, False
    while not over:
        _, reward, ended, cut, _ = env.step(np.zeros(1, np.float32))
        paid, over = paid + reward, ended or cut
    assert paid == pytest.approx(-30.0)  # 3 s of 10 (1 rad)^2
    found = {row[0]: row[1] for row in returns(SCENE).rows}
    assert found["zero actions"] == pytest.approx(paid) and found["random actions"] < found["zero actions"]


def test_laws_of_a_scoreboard_stand_beside_the_bound_and_failed_ones_do_not() -> None:
    row = {"scene": SCENE.name, "case": "exact", "failures": 0}
    board = {
        "rows": [row | {"controller": "LQR", "cost": 4.0}, row | {"controller": "PD", "cost": 9.0, "failures": 1}],
        "bounds": [{"scene": SCENE.name, "case": "exact", "costs": [2.0]}],
    }
    found = returns(SCENE, json.loads(json.dumps(board)))
    assert found.head[-1] == "cost over the bound"
    assert found.rows[:2] == (("bound: no law is better", -2.0, 1.0), ("LQR", -4.0, 2.0))
    assert not any(r[0] == "PD" for r in found.rows)


def test_a_goal_that_is_no_equilibrium_has_no_lqr() -> None:
    assert under_lqr(scenes.get("slider-crank-run")) is None
    motion = under_lqr(SCENE)
    assert motion is not None and SCENE.cost(motion) == pytest.approx(3.511, rel=1e-3)  # docs/scoreboard

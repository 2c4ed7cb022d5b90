"""Returns of simple policies."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.scenes.registry import SCENES, VARIANTS
from pliant.studies.scene_pages.returns import charged, returns, under_lqr

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


def test_a_motion_that_leaves_its_bounds_is_charged_as_the_environment_does() -> None:
    gentle = scenes.get("single-link-slew-gentle")
    motion, env = under_lqr(gentle), PlantEnv(gentle)
    assert motion is not None and charged(SCENE, motion) == SCENE.cost(motion)  # where the tip may bend by 300 mm
    env.reset(seed=0)
    paid = 0.0
    for u in motion.u:
        _, reward, ended, _, _ = env.step(u / gentle.limits)
        paid -= reward
        if ended:
            break
    assert ended and charged(gentle, motion) == pytest.approx(paid, rel=1e-6)
    found = {name: value for name, value, *_ in returns(gentle).rows}
    assert found["LQR"] == -charged(gentle, motion) < found["zero actions"]


@pytest.mark.parametrize("name", [*SCENES, *VARIANTS])
def test_docstrings_tell_the_pages_returns(name: str) -> None:
    """To four digits; what stands on the page of a scene is made by `returns` from the scoreboards."""
    page = Path(__file__).parents[3] / "docs" / "environments" / f"{name}.md"
    told = dict(
        re.findall(r"^\| ([^|]+?) \| (-[\d.]+) ", page.read_text("utf-8").partition("## Returns")[2], re.MULTILINE)
    )
    maker = {**SCENES, **VARIANTS}[name]
    rows = re.findall(r"\| ([^|]+?) +\| (-[\d.]+) +\|\n", (maker.__doc__ or "").partition("| policy")[2])
    assert {"LQR", "zero actions", "random actions"} <= {policy for policy, _ in rows}
    assert ("bound: no law is better" in dict(rows)) == ("bound: no law is better" in told)
    for policy, value in rows:
        assert float(value) == pytest.approx(float(told[policy]), rel=5.1e-4), policy

"""Learners of Stable-Baselines3 with their defaults, as docs/learning.md runs them."""

import re
from pathlib import Path

import pytest

pytest.importorskip("stable_baselines3")

PAGE = Path(__file__).parents[2] / "docs" / "learning.md"
FIRST, LOOP, TASKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
NOTHING = 30.0  # the cost of doing nothing on single-link-slew: ten per second for three seconds


@pytest.mark.campaign
def test_ppo_beats_doing_nothing_by_five_times() -> None:
    found: dict = {}
    exec(FIRST, found)
    assert found["cost"] < NOTHING / 5


def test_the_other_blocks_run() -> None:
    found: dict = {}
    exec(LOOP + TASKS, found)
    assert found["gains"].grad.abs().min() > 0
    assert found["hard"].observation_space.shape == (8 + 3 * (8 + 2),)

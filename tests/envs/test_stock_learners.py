"""Learners of Stable-Baselines3 with their defaults, as docs/learning.md runs them."""

import re
from pathlib import Path

import pytest

pytest.importorskip("stable_baselines3")

PAGE = Path(__file__).parents[2] / "docs" / "learning.md"
FIRST, LAW, LOOP, TASKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
NOTHING = 30.0  # the cost of doing nothing on single-link-slew: ten per second for three seconds


@pytest.mark.campaign
def test_ppo_beats_doing_nothing_by_five_times(tmp_path, monkeypatch) -> None:
    """And what it learned costs the same as a law without PyTorch."""
    monkeypatch.chdir(tmp_path)
    found: dict = {}
    exec(FIRST + LAW, found)
    assert found["cost"] < NOTHING / 5
    scene = found["scene"]
    played = scene.cost(scene.plant.simulate(scene.initial[0], found["policy"], scene.times))
    assert played == pytest.approx(found["cost"], rel=1e-3)


def test_the_other_blocks_run() -> None:
    found: dict = {}
    exec(LOOP + TASKS, found)
    assert found["gains"].grad.abs().min() > 0
    assert found["hard"].observation_space.shape == (8 + 3 * (8 + 2),)

"""Learners of Stable-Baselines3 with their defaults, as docs/learning.md runs them."""

import re
from pathlib import Path

import pytest

pytest.importorskip("stable_baselines3")

PAGE = Path(__file__).parents[2] / "docs" / "learning.md"
FIRST, LAW, LOOP, _, TASKS, MIXED = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
NOTHING = 30.0  # the cost of doing nothing on single-link-slew: ten per second for three seconds


@pytest.mark.campaign
def test_ppo_beats_doing_nothing_by_five_times() -> None:
    found: dict = {}
    exec(FIRST, found)
    assert found["cost"] < NOTHING / 5


@pytest.mark.campaign
def test_sac_does_after_half_as_many_actions_in_four_times_as_many_lanes() -> None:
    found: dict = {}
    exec(FIRST.replace("PPO", "SAC").replace("sb3_env(2,", "sb3_env(8,").replace("32_768", "16_384"), found)
    assert type(found["model"]).__name__ == "SAC" and found["model"].num_timesteps == 16_384
    assert found["cost"] < NOTHING / 5


def test_the_other_blocks_run(tmp_path, monkeypatch) -> None:
    """The law without PyTorch asks for what the model predicts, in the inputs' units, within the limits."""
    monkeypatch.chdir(tmp_path)
    found: dict = {}
    exec(LAW, found)
    scene, x = found["scene"], found["scene"].initial[0]
    seen = scene.signal_values(x, scene.plant.measure(x), scene.observe) - scene.goal_values(scene.observe)
    asked = 0.5 * found["plain"].predict(seen.astype("float32"), deterministic=True)[0] * scene.limits  # nothing pulls
    y = dict(zip((s.name for s in scene.signals), [*x, *scene.plant.measure(x)]))
    assert found["policy"].act(0.0, [y[name] for name in found["policy"].reads]) == pytest.approx(asked, rel=1e-4)
    exec(LOOP + TASKS + MIXED, found)
    assert found["gains"].grad.abs().min() > 0
    assert set(found["info"]["fidelity"]) == {"rigid", "linear, clamped-free 2+2", "stiffened, payload 2+2"}
    assert found["hard"].observation_space.shape == (8 + 3 * (8 + 2),)

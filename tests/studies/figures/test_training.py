"""The picture of a policy's training."""

from types import SimpleNamespace

from pliant.envs import scenes
from pliant.studies.figures.controllers import learning_curve


def test_costs_against_million_steps_beside_lqr():
    curve = [SimpleNamespace(steps=n, cost=c, seconds=s) for n, c, s in ((1e6, 9.0, 10.0), (2e6, 5.0, 20.0))]
    (ax,) = learning_curve(scenes.get("single-link-slew"), "ppo", curve, 3.5).axes
    lines = {line.get_label(): line for line in ax.lines}
    assert list(lines) == ["PPO", "LQR", "twice LQR"] and list(lines["PPO"].get_xdata()) == [1.0, 2.0]
    assert list(lines["PPO"].get_ydata()) == [9.0, 5.0] and lines["twice LQR"].get_ydata()[0] == 7.0
    assert ax.get_title("left") == "single-link-slew: 20 s of training"
    (bare,) = learning_curve(scenes.get("single-link-slew"), "sac", curve, None).axes
    assert [line.get_label() for line in bare.lines] == ["SAC"]

import re

import pytest

from pliant.envs import scenes
from pliant.envs.scene_files import save
from pliant.envs.scene_files.settings import with_settings


def test_signals_limits_and_factors_are_set_by_name(tmp_path):
    path = tmp_path / "reach.toml"
    save(scenes.get("two-link-reach"), path)
    settings = ["goal.theta1=0.3", "weights.tip_x=5", "limits.tau2=9", "randomise.link1.E=[0.9,1.1]"]
    settings += ["payload.mass=0.7", "modes=(1,1)", "observe=['theta1','theta2']", "start_spread=0"]
    found = with_settings(str(path), settings)
    assert dict(found.goal) == {"theta1": 0.3, "theta2": 0.6} and dict(found.weights)["tip_x"] == 5.0
    assert found.limits == (40.0, 9.0) and found.randomise[1] == ("link1.E", 0.9, 1.1)
    assert found.plant.payload.mass == 0.7 and found.plant.modes == (1, 1)
    assert found.observe == ("theta1", "theta2") and found.start_spread == 0


def test_settings_change_keywords_parameters_and_fields():
    scene = with_settings("spin-up", ["speed=4", "link.E=8e10", "duration=30"])
    assert dict(scene.goal)["hub_angle_rate"] == 4.0 and scene.plant.link.E == 8e10 and scene.duration == 30.0


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("goal.theta1", "must be NAME=VALUE"),
        ("goal.theta9=1", "goal 'theta9' must be one of theta1"),
        ("goal.theta1=high", "--set goal.theta1=high must be a value like 0.0"),
        ("weights.theta1=-1", "--set weights.theta1 = -1.0 must be >= 0"),
        ("limits.tau3=1", "--set limits.tau3='1': input 'tau3' must be one of tau1, tau2"),
        ("randomise.payload.mass=2", "must be two factors"),
        ("payload.colour=2", "Payload has no 'colour'"),
        ("payload.mass='1'", "--set payload.mass = '1' must be a finite number"),
        ("payload.mass=-1", "--set payload.mass = -1.0: Payload.mass = -1.0 must be >= 0"),
        ("payload.mass=[1]", "Payload.mass = (1,) must be a number"),
        ("goal.theta1=" + "1" * 2000, "a value of 2000 characters"),
        ("goal.theta1=__import__('os')", "must be a value like"),
    ],
)
def test_what_cannot_be_set_is_named(setting, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        with_settings("two-link-reach", [setting])

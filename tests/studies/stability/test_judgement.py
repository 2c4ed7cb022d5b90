"""The stability verdict of a report: the command's own, within its time, or why there is none."""

import dataclasses
import json

import numpy as np
import pytest
from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.plants import IntegrationError
from pliant.studies.commands.cli import app
from pliant.studies.common.atomic_files import dumps
from pliant.studies.stability import judgement
from pliant.studies.stability.judgement import judge

DROP = scenes.get("cantilever-drop")


def test_it_is_what_the_command_prints():
    """All of `pliant stability cantilever-drop --json`: about where it hangs, an undamped beam only swings."""
    done = CliRunner().invoke(app, ["stability", "cantilever-drop", "--json"])
    told, found = json.loads(done.stdout), json.loads(dumps(judge(DROP, seconds=600.0).to_json()))
    assert found == {"reason": None, **{key: told[key] for key in told if key not in ("scene", "plant")}}
    assert found["at_the_goal"]["verdict"] == "marginal" and found["left_out"] == []


def test_it_is_cut_off_and_says_so():
    """No time ends the motion; a model that is too large is not judged. The verdict at the goal stays."""
    for options, says in (
        ({"seconds": 0.0}, "cut off: the motion and its linear model took more than 0 s of processor time"),
        ({"largest": 1e4}, "cut off: 401 nodes of 6 states would take too long"),
    ):
        found = judge(DROP, **options)
        assert found.found is None and found.reason == says and found.at_the_goal is not None
        assert found.to_json()["verdict"] is None and found.to_json()["reason"] == says


def test_a_motion_that_fails_is_the_reason(monkeypatch):
    def fail(*_):
        raise IntegrationError("the motion diverges", time=0.1, state=np.zeros(6), step=1e-3)

    monkeypatch.setattr(judgement, "model_along", fail)
    assert judge(DROP).reason.startswith("IntegrationError: the motion diverges")


def test_progress_grows_to_one():
    seen = []
    judge(dataclasses.replace(DROP, duration=1.0), progress=lambda fraction, _: seen.append(fraction))
    assert seen == sorted(seen) and seen[-1] == 1.0


@pytest.mark.campaign
@pytest.mark.every(2)
@pytest.mark.parametrize(
    ("name", "left"), [("spacecraft-orbit", "wheel1_momentum"), ("spacecraft-slew", "quaternion_0")]
)
def test_what_is_left_out_is_told(name, left):
    found = judge(scenes.get(name), seconds=600.0)
    assert left in found.left_out and left in found.to_json()["left_out"]

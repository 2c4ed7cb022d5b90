"""`pliant train`: the folder, the table, the picture, and bad input in one line."""

import json
import sys

import pytest
from typer.testing import CliRunner

from pliant.studies.commands.cli import app

SCENE = "single-link-slew"


def run(*words):
    return CliRunner().invoke(app, ["train", *words])


@pytest.mark.campaign
def test_command_trains_and_goes_on(tmp_path):
    pytest.importorskip("stable_baselines3")
    given = [
        "--algorithm",
        "ppo",
        "--steps",
        "2560",
        "--num-envs",
        "64",
        "--threads",
        "1",
        "--out",
        str(tmp_path),
        "--json",
    ]
    first = run(SCENE, *given)
    assert first.exit_code == 0, first.stderr
    found = json.loads(first.stdout)
    assert found["scene"] == SCENE and found["steps"] == 2560 and found["lqr_cost"] == pytest.approx(3.511, rel=1e-3)
    assert (tmp_path / "curve.png").read_bytes().startswith(b"\x89PNG")
    made = json.loads((tmp_path / "policy.json").read_text())["made"]
    assert made["command"] == f"pliant train {SCENE} --algorithm ppo --seed 0 --steps 2560 --num-envs 64 --threads 1"
    again = run(SCENE, *given)
    assert again.exit_code == 2 and "resume" in again.stderr
    given[3] = "5120"
    more = run(SCENE, *given, "--resume")
    assert more.exit_code == 0, more.stderr
    assert json.loads(more.stdout)["steps"] == 5120 and "torch thread" in more.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("no-such-scene",), "no-such-scene"),
        ((SCENE, "--steps", "0"), "steps = 0"),
        ((SCENE, "--seconds", "1", "--steps", "1"), "give one of them"),
        ((SCENE, "--seed", "-1"), "seed = -1"),
    ],
)
def test_bad_input_is_one_line(tmp_path, words, message):
    done = run(*words, "--out", str(tmp_path / "out"))
    assert done.exit_code == 2 and message in done.stderr and len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_without_stable_baselines_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules["pliant.controllers.learning.train"], "_installed", lambda: False)
    done = run(SCENE, "--algorithm", "ppo", "--out", str(tmp_path / "out"))
    assert done.exit_code == 1 and "pliant[rl]" in done.stderr

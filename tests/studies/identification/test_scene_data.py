"""`pliant identify`: a scene's parameters from files, its three results, and words for what is wrong."""

import dataclasses
import json

import numpy as np
import pytest
from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.plants import Experiment, write_experiment
from pliant.studies.commands.cli import app
from pliant.studies.identification.scene_data import NAMES, numbers

SETTINGS = ("--set", "kinematics=rigid")


def run(*arguments):
    return CliRunner().invoke(app, ["identify", "single-link-slew", *map(str, arguments)])


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A rigid arm of 1.5 kg at its tip, by encoder."""
    scene = scenes.get("single-link-slew")
    arm = dataclasses.replace(
        scene.plant, kinematics="rigid", payload=dataclasses.replace(scene.plant.payload, mass=1.5)
    )
    t = np.linspace(0.0, 2.0, 201)
    motion = arm.simulate(None, 2 * np.sin(5 * t)[:, None], t)
    path = tmp_path_factory.mktemp("data") / "run.csv"
    write_experiment(arm, Experiment.of(motion, signals=("hub_angle",), noise={"hub_angle": 1e-4}), path)
    return path


def test_the_result_as_text_picture_and_json(data, tmp_path):
    done = run(data, "--vary", "payload.mass", *SETTINGS, "--out", tmp_path / "found", "--plot", tmp_path / "r.svg")
    assert done.exit_code == 0, done.output
    assert "payload.mass" in done.stdout and "hub_angle" in done.stdout
    table = json.loads((tmp_path / "found" / NAMES[1]).read_text())
    low, high = table["parameters"]["payload.mass"]["interval"]
    assert low < 1.5 < high and table["scene"] == "single-link-slew" and table["files"] == [str(data)]
    assert "payload.mass" in (tmp_path / "found" / NAMES[0]).read_text()
    assert (tmp_path / "found" / NAMES[2]).read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "r.svg").read_text()


def test_pairs_are_named_on_the_command_line(data):
    done = run(data, "--vary", "payload.mass", "--vary", "hub_inertia", *SETTINGS, "--json", "--start", "rest")
    table = json.loads(done.stdout)
    assert set(table["unidentifiable"][0]["names"]) == {"payload.mass", "hub_inertia"}
    said = run(data, "--vary", "payload.mass", "--vary", "hub_inertia", *SETTINGS, "--noise", "hub_angle=1e-4")
    assert "cannot be told apart" in " ".join(said.stdout.split())


def test_bounds_tries_and_an_unknown_start(data):
    given = ("--bound", "payload.mass=0.2:4", "--tries", "3", "--start", "unknown", "--hold", "linear", "--json")
    table = json.loads(run(data, "--vary", "payload.mass", *SETTINGS, *given).stdout)
    assert table["parameters"]["payload.mass"]["value"] == pytest.approx(1.5, rel=0.05) and table["tries"] == 3
    assert set(table["starts"][0]) == {"hub_angle", "hub_angle_rate"}


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--vary", "payload.weight"), "payload.weight"),
        (("--vary", "payload.mass", "--noise", "hub_angle"), "--noise 'hub_angle' must be NAME=VALUE"),
        (("--vary", "payload.mass", "--bound", "payload.mass=3"), "must be NAME=LOW:HIGH"),
        (("--vary", "payload.mass", "--noise", "tip=1"), "signal 'tip' must be one of"),
        (("--vary", "payload.mass", "--tries", "0"), "tries = 0 must be an integer"),
    ],
)
def test_refused_in_one_line(data, more, words):
    done = run(data, *more, *SETTINGS)
    said = [line for line in done.stderr.splitlines() if " % " not in line]
    assert done.exit_code == 2 and len(said) == 1 and words in said[0]


def test_a_file_that_is_none_is_refused(tmp_path):
    done = run(tmp_path / "no.csv", "--vary", "payload.mass")
    assert done.exit_code == 2 and "no.csv" in done.stderr


def test_numbers_from_words():
    assert numbers("--bound", ["a=1:2e3", "b=-1:1"], 2) == {"a": (1.0, 2000.0), "b": (-1.0, 1.0)}
    assert numbers("--noise", ["a=1e-3"], 1) == {"a": 1e-3}

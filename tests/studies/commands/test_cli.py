import json
import subprocess
import sys
from importlib.metadata import version

import numpy as np
import pytest
from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.plants import Trajectory
from pliant.studies.commands.cli import app

PNG = b"\x89PNG"


def run(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def json_of(*arguments):
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_version():
    assert run("--version").stdout.strip() == f"pliant {version('pliant')}"


def test_a_scenes_own_keywords_can_be_set():
    half = json_of("simulate", "spin-up", "--set", "speed=3", "--set", "duration=16", "--set", "link.E=8e10")
    assert half["signals"]["hub_angle_rate"][-1] == pytest.approx(3.0, rel=1e-6) and half["t"][-1] == 16.0
    for words, says in (
        (("spacecraft-spin", "--set", "axis=w"), "spacecraft-spin.axis = 'w' must be one of 'x', 'y', 'z'"),
        (("spin-up", "--set", "speed=-1"), "speed = -1.0 must be a number > 0"),
    ):
        done = run("simulate", *words)
        assert done.exit_code == 2 and says in " ".join(done.stderr.split())


def test_scenes():
    assert [s["name"] for s in json_of("scenes")] == list(scenes.names())
    assert "Scenes" in run("scenes").stdout


def test_simulate_saves_draws_and_prints(tmp_path):
    motion, picture = tmp_path / "motion.npz", tmp_path / "motion.png"
    result = run("simulate", "two-link-reach", "--out", motion, "--plot", picture)
    assert result.exit_code == 0 and "tip_x" in result.stdout
    assert "100 %" in result.stderr
    assert picture.read_bytes().startswith(PNG)
    expected = scenes.get("two-link-reach").open_loop(rtol=1e-8, atol=1e-10)
    assert np.allclose(Trajectory.load(motion)["tip_x"], expected["tip_x"], rtol=0, atol=1e-12)


def test_simulate_takes_settings_method_and_step():
    table = json_of(
        *("simulate", "single-link-slew", "--set", "payload.mass=0.7", "--set", "duration=1"),
        *("--set", "kinematics=rigid", "--method", "rk4", "--step", "0.002"),
    )
    assert table["plant"] == "rigid" and table["stats"]["step"] == 0.002
    assert table["t"][-1] == pytest.approx(1.0)
    assert table["signals"]["hub_angle"][-1] == pytest.approx(1.0, abs=0.05)


def test_simulate_under_lqr():
    table = json_of("simulate", "single-link-slew", "--lqr")
    assert table["signals"]["hub_angle"][-1] == pytest.approx(1.0, abs=1e-3)
    assert max(table["signals"]["hub_torque"]) <= 40.0


@pytest.mark.parametrize("at", ["goal", "start"])
def test_linearize(at, tmp_path):
    scene = scenes.get("two-link-reach")
    table = json_of("linearize", "two-link-reach", "--at", at, "--plot", tmp_path / "eigenvalues.svg")
    point = scene.target if at == "goal" else scene.initial
    assert table["A"] == scene.plant.linearize(*point).A.tolist()
    assert "<svg" in (tmp_path / "eigenvalues.svg").read_text()
    assert "frequency" in run("linearize", "two-link-reach", "--at", at).stdout


def test_chart(tmp_path):
    picture, table = tmp_path / "chart.png", tmp_path / "chart.json"
    found = json_of("chart", "single-link-slew", "--budget", "0.5", "--plot", picture, "--out", table)
    assert found == json.loads(table.read_text())
    assert picture.read_bytes().startswith(PNG)
    assert "Pareto" in run("chart", "single-link-slew", "--budget", "0.2").stdout


def test_choose(tmp_path):
    picture = tmp_path / "ladder.png"
    found = json_of("choose", "single-link-slew", "--tolerance", "1e-3", "--plot", picture)
    assert found["met"] and found["chosen"] != "rigid"
    assert picture.read_bytes().startswith(PNG)
    result = run("choose", "single-link-slew", "--tolerance", "1e-12")
    assert result.exit_code == 1 and "no variant is shown to keep the tolerance" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("simulate", "three-link"), "scenes.name = 'three-link' must be one of"),
        (("simulate", "two-link-reach", "--set", "payload.mass"), "must be NAME=VALUE"),
        (("simulate", "two-link-reach", "--set", "payload.mass=heavy"), "payload.mass=heavy must be a value like"),
        (("simulate", "two-link-reach", "--set", "payload.mass=-1"), "Payload.mass = -1.0 must be"),
        (("simulate", "two-link-reach", "--set", "payload.colour=1"), "Payload has no 'colour'"),
        (("simulate", "two-link-reach", "--set", "basis=fourier"), "TwoLinkArm.basis = 'fourier' must be one of"),
        (("simulate", "two-link-reach", "--set", "duration=-1"), "duration = -1.0 must be"),
        (("simulate", "two-link-reach", "--method", "euler"), "simulate.method = 'euler' must be one of"),
        (("simulate", "two-link-reach", "--method", "rk4"), "step = None must be"),
        (("simulate", "two-link-reach", "--rtol", "0"), "--rtol 0.0 must be within"),
        (("simulate", "single-link-slew", "--plot", "motion.xyz"), "must end with one of"),
        (("simulate", "single-link-slew", "--out", "no/such/folder/m.npz"), "no/such/folder"),
        (("linearize", "two-link-reach", "--at", "noon"), "'noon' is not one of"),
        (("chart", "single-link-slew", "--budget", "0"), "chart.budget = 0.0 must be > 0"),
        (("choose", "single-link-slew", "--tolerance", "-1"), "choose.tolerance = -1.0 must be a number > 0"),
        (("report", "single-link-slew", "--out", __file__), "must be a folder"),
        (("fly", "single-link-slew"), "No such command 'fly'"),
    ],
)
def test_bad_input_ends_with_its_message_and_code_2(arguments, message):
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.replace("│", " ").split())
    assert "Traceback" not in result.output and result.stdout == ""


def test_failure_of_a_simulation_ends_with_code_1():
    result = run("simulate", "two-link-reach", "--method", "rk4", "--step", "0.02")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1].startswith("error: StabilityLimitError: rk4 with a step of 0.02 s")


def test_start_up_does_not_import_what_draws():
    code = (
        "import sys, pliant.studies.commands.cli; "
        "sys.exit(any(m in sys.modules for m in ('matplotlib', 'control', 'rich')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

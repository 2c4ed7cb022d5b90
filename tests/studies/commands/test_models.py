"""`pliant simulate` and `pliant linearize`."""

import json

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


def test_failure_of_a_simulation_ends_with_code_1():
    result = run("simulate", "two-link-reach", "--method", "rk4", "--step", "0.02")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1].startswith("error: StabilityLimitError: rk4 with a step of 0.02 s")

"""`pliant stability SCENE`: the table, the picture, JSON, bad input."""

import json

import pytest
import typer
from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.plants.stability import METHODS
from pliant.studies.console import Commands
from pliant.studies.stability_command import stability, verdict_of

SHORT = ("--set", "duration=1.2", "--set", "move_time=0.6")


@pytest.fixture(scope="module")
def run():
    app = typer.Typer(cls=Commands)
    app.command()(stability)
    app.command("other")(lambda: None)
    return lambda *words: CliRunner().invoke(app, ["stability", *words])


def test_table_and_picture(run, tmp_path):
    done = run("two-link-reach", *SHORT, "--plot", str(tmp_path / "s.png"))
    assert done.exit_code == 0, done.output
    assert all(name in done.stdout for name in METHODS)
    assert "two-link-reach:" in done.stdout and "frozen roots in" in done.stdout
    assert (tmp_path / "s.png").stat().st_size > 10_000


def test_json_is_json_alone(run):
    done = run("two-link-reach", *SHORT, "--json")
    found = json.loads(done.stdout)
    assert found["scene"] == "two-link-reach" and found["verdict"] in ("stable", "unstable", "marginal", "undecided")
    assert set(found["reasons"]) == set(METHODS) - {found["method"]}
    verdict, model = verdict_of(scenes.get("two-link-reach", duration=1.2, move_time=0.6))
    assert verdict.verdict == found["verdict"] and len(model.t) >= 401


def test_bad_input_ends_with_its_message(run):
    done = run("two-link-reach", *SHORT, "--period", "-3")
    assert done.exit_code == 2 and "floquet.period = -3.0 must be > 0" in done.stderr
    assert run("no-such-scene").exit_code == 2

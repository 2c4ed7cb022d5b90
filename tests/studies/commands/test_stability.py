"""`pliant stability SCENE`: the table, the picture, JSON, bad input."""

import json

import pytest
import typer
from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.plants.stability import METHODS
from pliant.studies.commands.console import Commands
from pliant.studies.commands.stability import stability
from pliant.studies.common.atomic_files import dumps
from pliant.studies.stability.over_ranges import over_ranges
from pliant.studies.stability.verdicts import verdict_at_goal, verdict_of

SHORT = ("--set", "duration=1.2", "--set", "move_time=0.6")


@pytest.fixture
def run(tmp_path, monkeypatch):
    """In a folder of its own, where the picture goes."""
    monkeypatch.chdir(tmp_path)
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


@pytest.mark.campaign
def test_json_is_json_alone(run):
    """All that the verdict holds, and nothing beside it on stdout; the nominal is swung once: nothing decides."""
    done = run("two-link-reach", *SHORT, "--json")
    found = json.loads(done.stdout)
    scene = scenes.get("two-link-reach", duration=1.2, move_time=0.6)
    verdict, model = verdict_of(scene)
    goal = verdict_at_goal(scene)
    told = {"scene": scene.name, "plant": scene.plant.label, "left_out": [], "at_the_goal": goal.to_json()}
    told["over_ranges"] = over_ranges(scene) or None
    assert found == json.loads(dumps({**told, **verdict.to_json()}))
    assert found["verdict"] == "bounded" and set(found["reasons"]) | {found["method"]} == set(METHODS)
    assert found["at_the_goal"]["verdict"] == "stable" and len(model.t) >= 401


@pytest.mark.every(5)
@pytest.mark.parametrize(
    ("words", "says", "about_the_goal"),
    [
        (
            ("spacecraft-slew",),
            "bounded by growth",
            "marginal; 3 of 7 eigenvalues on the imaginary axis, the others decay",
        ),
        (
            ("spacecraft-spin",),
            "bounded by growth",
            "marginal; 1 of 7 eigenvalues on the imaginary axis, the others decay",
        ),
        (("spacecraft-spin", "--set", "axis=y"), "unstable by growth", "unstable; the fastest grows at 0.0285 1/s"),
        (("spacecraft-spin", "--set", "axis=x"), "bounded by growth", "unstable; the fastest grows at 1.2"),
        (("spacecraft-orbit",), "marginal by floquet", None),
    ],
    ids=lambda v: " ".join(v) if isinstance(v, tuple) else "",
)
def test_spacecraft(run, words, says, about_the_goal):
    """Free spin by Euler's equations (see tests/envs/scenes/test_spacecraft.py); in orbit within Lagrange's region."""
    done = run(*words)
    text = " ".join(done.stdout.split())
    assert done.exit_code == 0 and f"{words[0]}: {says}" in text and "left out" in text
    if about_the_goal is None:
        assert "About the goal alone" not in text and "6 of 10 multipliers on the unit circle" in text
    else:
        assert f"About the goal alone, which is an equilibrium: {about_the_goal}" in text


def test_bad_input_ends_with_its_message(run):
    done = run("two-link-reach", *SHORT, "--period", "-3")
    assert done.exit_code == 2 and "--period = -3.0 must be > 0" in done.stderr
    assert run("no-such-scene").exit_code == 2

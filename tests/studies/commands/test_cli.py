import importlib
import json
import os
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from pliant.studies.commands.cli import COMMANDS, EXAMPLES, app


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
        (("spin-up", "--set", "speed=-1"), "speed = -1.0 must be > 0"),
    ):
        done = run("simulate", *words)
        assert done.exit_code == 2 and says in " ".join(done.stderr.split())


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
        (("choose", "single-link-slew", "--tolerance", "-1"), "choose.tolerance = -1.0 must be > 0"),
        (("report", "single-link-slew", "--out", __file__), "must be a folder"),
        (("fly", "single-link-slew"), "No such command 'fly'"),
    ],
)
def test_bad_input_ends_with_its_message_and_code_2(arguments, message):
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.replace("│", " ").split())
    assert "Traceback" not in result.output and result.stdout == ""


def test_start_up_does_not_import_what_draws():
    code = (
        "import sys, pliant.studies.commands.cli; "
        "sys.exit(any(m in sys.modules for m in ('matplotlib', 'control', 'rich')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_pliant_alone_says_three_things_to_try():
    told = " ".join(run().output.split())
    assert all(
        words in told for words in ("pliant scenes", "pliant choose two-link-reach", "pliant report single-link")
    )


@pytest.mark.parametrize("name", COMMANDS)
def test_every_commands_help_has_an_example(name):
    """Its lines fit 80 columns, and its words are read by the command."""
    result = CliRunner().invoke(app, [name, "--help"], env={"COLUMNS": "80"})
    assert result.exit_code == 0 and max(map(len, result.output.splitlines())) <= 80
    shown = " ".join(result.output.partition("Example:")[2].split())
    assert shown == EXAMPLES[name] and shown.startswith(f"pliant {name}")


def test_examples_give_only_options_that_there_are():
    for name, example in EXAMPLES.items():
        told = CliRunner().invoke(app, [name, "--help"], env={"COLUMNS": "200"}).output
        assert all(word in told for word in example.split() if word.startswith("--")), name


def test_open_tells_the_newest_report(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("open")
    assert result.exit_code == 2 and "write one by `pliant report`" in result.stderr
    for age, name in ((100, "new"), (200, "old")):
        page = tmp_path / "reports" / name / "report.html"
        page.parent.mkdir(parents=True)
        page.write_text("a report")
        os.utime(page, (1e9 - age, 1e9 - age))
    assert run("open").stdout.strip() == str(Path("reports", "new", "report.html"))
    assert run("open", "old").stdout.strip() == str(Path("reports", "old", "report.html"))
    assert run("open", "*").exit_code == 2


def test_a_bad_call_ends_with_where_to_look():
    assert run("choose", "two-link-reach", "--tolerance", "-1").stderr.strip().endswith("(see `pliant choose --help`)")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_what_the_command_says(name):
    place, line = COMMANDS[name]
    module, function = place.split(":")
    said = getattr(importlib.import_module(f"pliant.studies.commands.{module}"), function).__doc__
    assert said.split("\n\n")[0].split("\n")[0] == line


def test_the_version_needs_no_plant():
    code = (
        "import sys; from pliant.studies.commands import cli; "
        "sys.exit(any(m.startswith(('pliant.plants.dynamics', 'pliant.envs', 'scipy')) for m in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_no_unit_is_taken_for_markup():
    """In a help text "[s]" is not printed: rich strikes what follows."""
    group = typer.main.get_command(app)
    context = group.make_context("pliant", ["scenes"], resilient_parsing=True)
    for name in group.list_commands(context):
        for parameter in group.get_command(context, name).params:
            told = getattr(parameter, "help", None) or ""
            assert not re.search(r"(?<!\\)\[[a-z/^ ]{1,6}\]", told), (name, parameter.name)

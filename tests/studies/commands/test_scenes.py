"""`pliant scenes`."""

import json

from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.studies.commands.cli import app


def run(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def json_of(*arguments):
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_scenes():
    assert [s["name"] for s in json_of("scenes")] == list(scenes.names())
    assert "Scenes" in run("scenes").stdout

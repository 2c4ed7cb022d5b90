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


def test_check_of_a_file_plays_its_scene(tmp_path):
    """A file whose plant is sound, and whose scene no other command could play."""
    file = tmp_path / "weak.toml"
    file.write_text('name = "weak"\nbase = "single-link-slew"\n')
    sound = run("check", file)
    assert sound.exit_code == 0 and "open loop" in sound.stdout and "mass matrix" in sound.stdout
    file.write_text('name = "weak"\nbase = "single-link-slew"\n[limits]\nhub_torque = 1e-3\n')
    unknown = run("check", "crane-swng")
    assert unknown.exit_code == 2 and unknown.stderr.endswith("or its name as `pliant scenes` lists it\n")
    refused = run("check", file)
    assert refused.exit_code == 2 and "nominal: inputs beyond the limits: hub_torque = " in refused.stderr
    assert "mass matrix" in refused.stdout

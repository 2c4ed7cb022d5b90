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
    """The variants stand below what they are variants of."""
    found = [s["name"] for s in json_of("scenes")]
    assert [name for name in found if name in scenes.names()] == list(scenes.names())
    for base, variant in (("single-link-slew", "gentle"), ("two-link-reach", "weak")):
        assert found[found.index(base) + 1] == f"{base}-{variant}"
    assert len(found) == len(scenes.names()) + 2
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

"""`pliant chart` and `pliant choose`."""

import json

from typer.testing import CliRunner

from pliant.studies.commands.cli import app

PNG = b"\x89PNG"


def run(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def json_of(*arguments):
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


SHORT = ("--set", "duration=0.3", "--set", "move_time=0.2")


def test_chart(tmp_path):
    picture, table = tmp_path / "chart.png", tmp_path / "chart.json"
    found = json_of("chart", "single-link-slew", *SHORT, "--budget", "0.2", "--plot", picture, "--out", table)
    assert found == json.loads(table.read_text())
    assert picture.read_bytes().startswith(PNG)
    assert "Pareto" in run("chart", "single-link-slew", *SHORT, "--budget", "0.2").stdout


def test_choose(tmp_path):
    picture = tmp_path / "ladder.png"
    found = json_of("choose", "single-link-slew", *SHORT, "--tolerance", "1e-3", "--plot", picture)
    assert found["met"] and found["chosen"] != "rigid"
    assert picture.read_bytes().startswith(PNG)
    result = run("choose", "single-link-slew", *SHORT, "--tolerance", "1e-12")
    assert result.exit_code == 1 and "no variant is shown to keep the tolerance" in result.stderr

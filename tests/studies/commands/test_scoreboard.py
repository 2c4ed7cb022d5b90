"""`pliant scoreboard`: json, the folder, bad input."""

import json

import pytest
from typer.testing import CliRunner

from pliant.studies.commands.cli import app


@pytest.mark.campaign
def test_command(tmp_path):
    arguments = ["scoreboard", "single-link-slew", "--controllers", "LQR", "--seeds", "2", "--bounds", "1"]
    done = CliRunner().invoke(app, [*arguments, "--jobs", "1", "--json", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    table = json.loads(done.stdout)
    assert [r["case"] for r in table["rows"]] == ["exact", "finer", "varied", "delayed", "all at once"]
    assert table["command"].startswith("pliant scoreboard single-link-slew --seeds 2 --controllers LQR --bounds 1")
    assert (tmp_path / "scoreboard.md").is_file() and "100 %" in done.stderr
    done = CliRunner().invoke(app, ["scoreboard", "verify", str(tmp_path), "--cells", "3", "--json"])
    assert done.exit_code == 0 and json.loads(done.stdout)["passed"]
    done = CliRunner().invoke(app, ["scoreboard", "--law", "nothing.py:Law"])
    assert done.exit_code == 2 and "there is no file 'nothing.py'" in done.stderr
    done = CliRunner().invoke(app, ["scoreboard", "nowhere"])
    assert done.exit_code == 2 and "scoreboard.scenes = 'nowhere' must be one of" in done.stderr
    done = CliRunner().invoke(app, ["scoreboard", "--controllers", "magic"])
    assert done.exit_code == 2 and "scoreboard.controllers = 'magic' must be one of" in done.stderr


def test_a_folder_without_policies_is_told(tmp_path):
    done = CliRunner().invoke(app, ["scoreboard", "single-link-slew", "--policies", str(tmp_path)])
    assert done.exit_code == 2 and "must hold folders SCENE-SEED" in done.stderr

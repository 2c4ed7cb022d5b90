"""`pliant chart` and `pliant choose`."""

import importlib
import json

import pytest
from made_up_charts import made_up_chart
from typer.testing import CliRunner

from pliant.envs.scenes import SCENES
from pliant.plants import SingleLinkArm
from pliant.studies.commands.cli import app

PNG = b"\x89PNG"


def run(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def json_of(*arguments):
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


SHORT = ("--set", "duration=0.3", "--set", "move_time=0.2")


ENOUGH = ("--budget", "20")


@pytest.fixture
def small(monkeypatch):
    """Two variants: what a ladder of ten adds is time."""
    ladder = SingleLinkArm.ladder
    monkeypatch.setattr(SingleLinkArm, "ladder", lambda self: ladder(self)[:2])


def test_chart(small, tmp_path):
    picture, table = tmp_path / "chart.png", tmp_path / "chart.json"
    found = json_of("chart", "single-link-slew", *SHORT, *ENOUGH, "--plot", picture, "--out", table)
    assert found == json.loads(table.read_text())
    assert picture.read_bytes().startswith(PNG)


def test_a_chart_into_a_folder_goes_on_and_is_another_scenes_no_more(small, tmp_path):
    told = run("chart", "single-link-slew", *SHORT, *ENOUGH, "--out", tmp_path / "charts")
    assert told.exit_code == 0 and "the Pareto fronts" in told.stdout
    names = {f"single-link-slew{ending}" for ending in (".html", ".png", ".json", ".rows.jsonl")}
    assert {p.name for p in (tmp_path / "charts").iterdir()} == names
    again = run("chart", "single-link-slew", "--set", "duration=0.4", "--out", tmp_path / "charts")
    assert again.exit_code == 2 and "holds rows of other settings of it" in again.stderr


def test_a_budget_that_is_too_small_says_which_is_enough(small, tmp_path):
    told = run("chart", "single-link-slew", *SHORT, "--budget", "1e-6")
    assert told.exit_code == 1
    assert "the budget of 1e-06 s bought no row of " in told.stderr and "s would buy each variant one" in told.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("chart",), "chart: name a scene, or give --all and --out"),
        (("chart", "--all"), "chart --all needs --out, a folder"),
        (("chart", "spin-up", "--all", "--out", "x"), "chart --all charts every shipped scene as it is"),
    ],
)
def test_what_a_chart_must_be_told(arguments, message):
    told = run(*arguments)
    assert told.exit_code == 2 and message in told.stderr


def test_every_scene(monkeypatch, tmp_path):
    module = importlib.import_module("pliant.studies.commands.fidelity")
    asked = []

    def gallery(out, **options):
        asked.append((out, options["budget"], options["peers"]))
        return [made_up_chart(scene=name) for name in SCENES]

    monkeypatch.setattr(module, "gallery", gallery)
    told = run("chart", "--all", "--out", tmp_path / "all", "--budget", "2", "--peers")
    assert told.exit_code == 0 and told.stdout.strip() == str(tmp_path / "all" / "index.html")
    assert asked == [(tmp_path / "all", 2.0, True)]
    monkeypatch.setattr(module, "gallery", lambda out, **_: [made_up_chart()])
    assert run("chart", "--all", "--out", tmp_path / "all").exit_code == 1  # some could not be charted


def test_choose(small, tmp_path):
    picture = tmp_path / "chart.png"
    found = json_of("choose", "single-link-slew", *SHORT, "--tolerance", "1e-3", *ENOUGH, "--plot", picture)
    assert found["met"] and found["chosen"] != "rigid"
    assert picture.read_bytes().startswith(PNG)
    result = run("choose", "single-link-slew", *SHORT, "--tolerance", "1e-12")
    assert result.exit_code == 1 and "no variant is shown to keep the tolerance" in result.stderr

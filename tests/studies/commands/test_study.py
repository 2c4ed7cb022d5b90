"""`pliant study effectivity`: table, picture, json and what it refuses. The study itself is replaced."""

import json

import pytest
from typer.testing import CliRunner

from pliant.studies.commands import fidelity
from pliant.studies.commands.cli import app
from pliant.studies.effectivity.effectivity import Effectivity


def row(seed, true):
    rung = {"variant": "v", "predicted": 0.5, "bound": 0.5, "true": true}
    made = {"seed": seed, "kind": "drop", "failure": "", "met": True, "tolerance": 1.0, "uncertainty": 1e-4}
    costs = {"cpu": 1.0, "cpu_chosen": 1.0, "cpu_finest": 1.0, "wall": 1.0}
    return made | costs | {"true": true, "bound": 0.5, "rungs": [rung]}


@pytest.fixture
def run(monkeypatch):
    asked = {}

    def study(seeds, **options):
        asked.update(options, seeds=list(seeds))
        return Effectivity(tuple(row(k, 1.5 if k == 9 else 0.5) for k in seeds))

    monkeypatch.setattr(fidelity, "effectivity", study)
    return asked, lambda *words: CliRunner().invoke(app, ["study", *map(str, words)])


def test_table_picture_and_json(run, tmp_path):
    asked, call = run
    out, plot, kept = tmp_path / "e.json", tmp_path / "e.png", tmp_path / "rows.jsonl"
    done = call("effectivity", "--seeds", "2:5", "--jobs", 2, "--out", out, "--plot", plot, "--kept", kept)
    assert done.exit_code == 0, done.output
    assert asked["seeds"] == [2, 3, 4] and asked["jobs"] == 2 and asked["kept"] == kept
    assert "wrongly met" in done.stdout and json.loads(out.read_text())["summary"]["scenes"] == 3
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert json.loads(call("effectivity", "--seeds", "2", "--json").stdout)["rows"][0]["seed"] == 2


def test_a_wrong_one_is_a_status(run):
    done = run[1]("effectivity", "--seeds", "8:10")
    assert done.exit_code == 1 and "1 wrongly met, 0 crashed" in done.stderr


@pytest.mark.parametrize("words", (("other",), ("effectivity", "--seeds", "5:2"), ("effectivity", "--seeds", "a:b")))
def test_refused(run, words):
    assert run[1](*words).exit_code == 2

import json
import platform
import re
import sys
from html import unescape

import pytest
from typer.testing import CliRunner

from pliant.envs import scenes
from pliant.plants import Trajectory
from pliant.studies import report
from pliant.studies.commands.cli import app
from pliant.studies.common.formatting import measured, paragraph
from pliant.studies.stability.verdicts import verdict_of

pytestmark = pytest.mark.early  # all look at one report
SLEW = scenes.get("single-link-slew", duration=1.2, move_time=0.6)
SHORT = ("--set", "duration=1.2", "--set", "move_time=0.6")
TABLES = {
    "modes",
    "linearization",
    "linearization_along",
    "closed_loop",
    "stability",
    "controllers",
    "speed_accuracy",
    "choice",
    "machine",
    "report",
}
FIGURES = {
    "motion",
    "shapes",
    "tip_path",
    "eigenvalues",
    "stability",
    "closed_loop",
    "controllers",
    "speed_accuracy",
    "settings",
    "ladder",
    "effects",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A report that the command has written."""
    folder = tmp_path_factory.mktemp("reports") / "slew"
    arguments = ["report", SLEW.name, *SHORT, "--out", str(folder), "--budget", "0.3"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert result.stdout == f"{folder / 'report.html'}\n"
    shown = [int(tenth) for tenth in re.findall(r"(\d+) %", result.stderr)]
    assert shown == sorted(shown) and shown[0] == 0 and shown[-1] == 100
    return folder


def test_folder_holds_page_figures_and_tables(folder):
    names = {p.name for p in folder.iterdir()}
    expected = {f"{t}.json" for t in TABLES} | {f"{f}.png" for f in FIGURES} | {"report.html", "open_loop.npz"}
    assert names == expected
    assert set(json.loads((folder / "report.json").read_text())["files"]) == names
    assert [p.name for p in folder.parent.iterdir()] == ["slew"]


def test_tables_are_strict_json(folder):
    def refuse(word):
        raise AssertionError(word)

    for path in folder.glob("*.json"):
        json.loads(path.read_text(), parse_constant=refuse)
    for path in folder.glob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")


def test_tables_say_what_was_computed(folder):
    linear = json.loads((folder / "linearization.json").read_text())
    assert linear["A"] == SLEW.plant.linearize(*SLEW.target).A.tolist()
    errors = json.loads((folder / "linearization_along.json").read_text())["prediction_errors"]
    assert errors[0]["error"] / errors[1]["error"] == pytest.approx(100.0, rel=0.3)
    loops = json.loads((folder / "closed_loop.json").read_text())["loops"]
    assert [loop["stable"] for loop in loops] == [True] * 4
    motion = Trajectory.load(folder / "open_loop.npz")
    assert motion.t.tolist() == pytest.approx(SLEW.times.tolist())


def rounded(value):
    """To twelve digits: what is seen of motions is compiled on the way, which rounds otherwise."""
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [rounded(entry) for entry in value]
    return float(f"{value:.12g}") if isinstance(value, float) else value


def test_stability_is_what_the_command_prints(folder):
    found = json.loads((folder / "stability.json").read_text())
    told = json.loads(CliRunner().invoke(app, ["stability", SLEW.name, *SHORT, "--json"]).stdout)
    wanted = {"reason": None, **{key: told[key] for key in told if key not in ("scene", "plant")}}
    assert rounded(found) == rounded(wanted)
    verdict, _ = verdict_of(SLEW)
    assert found["at_the_goal"]["verdict"] == "marginal"  # a hub that is free to turn
    text = unescape((folder / "report.html").read_text(encoding="utf-8"))
    answer = text[text.index("<h2>The answer") : text.index("<h2>The motion")]
    plain = answer.replace("<code>", "`").replace("</code>", "`")
    assert verdict.sentence in plain
    assert all(words in text for _, _, words in verdict.rows())
    assert "<code>pliant stability" not in text  # this scene is shorter than what the command finds by the name


def test_controllers_are_played_on_two_plants(folder):
    found = json.loads((folder / "controllers.json").read_text())
    runs = {(run["controller"], run["states"]): run for run in found["runs"]}
    assert found["horizon"] == 20
    assert list(runs) == [(name, n) for n in (6, 14) for name in ("LQR", "MPC", "trained policy")]
    loops = json.loads((folder / "closed_loop.json").read_text())["loops"]
    assert runs["LQR", 6]["cost"] == pytest.approx(loops[0]["cost"], rel=1e-12)
    assert runs["LQR", 14]["cost"] == pytest.approx(loops[-1]["cost"], rel=1e-12)
    assert all(run["failure"] == "" and run["peak"] < 0.3 for run in found["runs"])
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert f"LQR {runs['LQR', 6]['cost']:.4g}, MPC {runs['MPC', 6]['cost']:.4g}, trained policy" in text


def test_page_is_self_contained(folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "http" not in text and "url(" not in text.replace("url(#", "") and "@import" not in text
    assert all(target.startswith("#") for target in re.findall(r'(?:href|src)="([^"]*)"', text))
    assert text.count("<figure") == len(FIGURES)
    assert text.count("<svg") == len(FIGURES) + 1
    assert "currentColor" in text


def test_page_names_no_host_and_no_folder(folder):
    text = (folder / "report.html").read_text(encoding="utf-8") + (folder / "machine.json").read_text()
    assert str(folder.parent) not in text
    assert len(platform.node()) < 5 or platform.node() not in text


def test_failure_leaves_nothing(tmp_path, monkeypatch):
    def stop(*_):
        raise RuntimeError("stopped")

    module = sys.modules["pliant.studies.report.report"]
    monkeypatch.setattr(module, "study", lambda *_, **__: None)
    monkeypatch.setattr(module, "figures_of", stop)
    with pytest.raises(RuntimeError, match="stopped"):
        report(SLEW, tmp_path / "new")
    assert list(tmp_path.iterdir()) == []


def test_other_files_are_not_replaced(tmp_path):
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(ValueError, match="must be absent, empty or a former report"):
        report(SLEW, tmp_path)
    with pytest.raises(ValueError, match="must be a folder"):
        report(SLEW, tmp_path / "thesis.txt")
    assert (tmp_path / "thesis.txt").read_text() == "years of work"


def test_lengths_and_code_as_people_read_them():
    assert [measured(value, "m") for value in (9.4e20, 12.0, 2e-3, 3e-6)] == ["> 1000 km", "12 m", "2 mm", "3 µm"]
    assert paragraph("see `pliant <x>`") == "<p>see <code>pliant &lt;x&gt;</code></p>\n"

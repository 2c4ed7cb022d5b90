"""What the commands share: names that never break, settings by name, JSON."""

import warnings
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.envs import environment_id, scenes
from pliant.plants import NominalWarning
from pliant.studies.commands import console
from pliant.studies.commands.cli import app
from pliant.studies.commands.console import BORDERS, beside, column_widths, listed, say, say_lines, show

LADDER = ("rigid", "stiffened, payload 4", "linear, 2 appendages, 2 modes, rotation only")


@pytest.mark.parametrize("columns", ["80", "60", None])
def test_scenes_breaks_no_name(columns, monkeypatch):
    """At 80 columns, at 60, and into a pipe."""
    monkeypatch.delenv("COLUMNS", raising=False)
    if columns:
        monkeypatch.setenv("COLUMNS", columns)
    done = CliRunner().invoke(app, ["scenes"])
    lines = done.stdout.splitlines()
    assert done.exit_code == 0 and max(map(len, lines)) <= int(columns or 80)
    for name in scenes.names():
        for whole in (name, environment_id(name), scenes.get(name).plant.label):
            assert any(whole in line for line in lines), whole
        assert scenes.get(name).about in " ".join(done.stdout.split())


@pytest.mark.parametrize("columns", ["80", "60", "30"])
def test_tables_keep_names_and_words_whole(columns, monkeypatch, capsys):
    """Wider than the terminal where it must be."""
    monkeypatch.setenv("COLUMNS", columns)
    rows = [(label, 1.25, "agrees with the next rung, not with the finest") for label in LADDER]
    show("Ladder [m]", ("variant", "error [m]", "note"), rows, caption="confirmed [to a digit]")
    lines = capsys.readouterr().out.splitlines()
    assert all(any(label in line for line in lines) for label in LADDER)
    words = {word for line in lines for word in line.replace("│", " ").split()}
    assert {"agrees", "finest", "1.25", "[m]", "digit]"} <= words
    if columns == "80":
        assert max(map(len, lines)) <= 80


def test_a_table_that_does_not_fit_is_several(monkeypatch, capsys):
    """As the scoreboard's: thirteen columns, of which each stands once, beside the names."""
    monkeypatch.setenv("COLUMNS", "80")
    head = ["controller", *(f"column{k:02d} [mm]" for k in range(12))]
    show("Board", head, [["LQR, delay known", *(float(k) for k in range(12))]], caption="all runs")
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80 and out.count("controller") == out.count("LQR, delay known") == 3
    assert out.count("Board") == out.count("all runs") == 1
    assert [out.split().count(f"column{k:02d}") for k in range(12)] == [1] * 12


def test_which_columns_stand_beside_one_another():
    columns = [["names"], ["a" * 10], ["b" * 10], ["c" * 40]]
    assert beside(columns, 100, (0,)) == [[0, 1, 2, 3]]
    assert beside(columns, 40, (0,)) == [[0, 1, 2], [0, 3]]
    assert beside(columns, 1, (0,)) == [[0, 1], [0, 2], [0, 3]]


def test_lines_of_names_and_words_are_broken_below_the_words(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "40")
    say_lines("machine\n  energy      the power put in less the power lost\n  short       kept")
    assert capsys.readouterr().out.splitlines() == [
        *("machine", "  energy      the power put in less the", "              power lost", "  short       kept"),
    ]


def test_column_widths():
    """Room goes where it saves lines; whole columns have what they need."""
    columns = [["ab cd", "ef"], ["one two three four", "x"]]
    assert column_widths(columns, 100, (0,)) == [5, 18]
    assert column_widths(columns, 5 + 10 + 2 * BORDERS + 1, (0,)) == [5, 10]
    assert column_widths(columns, 1, (0,)) == [5, 5] and column_widths(columns, 1, ()) == [2, 5]


def test_lists_and_sentences_break_between_words(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "20")
    listed("Title", [(("a-name", "its/identifier-v0"), "some words in a sentence", ("one", "two", "a-long-last-fact"))])
    assert capsys.readouterr().out.splitlines() == [
        *("Title", "", "a-name", "its/identifier-v0", "  some words in a", "  sentence", "  one; two;"),
        "  a-long-last-fact",
    ]
    say("a two-link-reach-weak-long-name stays")
    assert "two-link-reach-weak-long-name" in capsys.readouterr().out.splitlines()


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="a folder with rights, and without room for files")
def test_a_folder_that_takes_no_files_is_refused_before_the_work():
    for gate, path in ((console.writable_folder, "/proc/x/y"), (console.writable, "/proc/x.png")):
        with pytest.raises(ValueError, match=r"--out '/proc/x.*written"):
            gate("--out", Path(path))


def test_asking_leaves_nothing(tmp_path):
    console.writable_folder("--out", tmp_path / "a" / "b")
    console.writable("--out", tmp_path / "a.png")
    assert not list(tmp_path.iterdir())


def test_a_picture_is_whatever_matplotlib_writes(tmp_path):
    console.drawable(tmp_path / "a.svgz")
    with pytest.raises(ValueError, match=r"--plot '.*a.doc' must end with one of .*png"):
        console.drawable(tmp_path / "a.doc")


def test_a_name_that_no_disk_takes_is_told_before_the_disk_is_asked(tmp_path):
    for gate in (console.writable, console.writable_folder):
        with pytest.raises(ValueError, match="--out has a name of 300 bytes, must be at most 255"):
            gate("--out", tmp_path / ("a" * 300))


def test_warnings_are_one_line_of_words():
    """Where a command was called from says nothing; of others' warnings it does."""
    line = console.in_words(warnings.formatwarning)
    assert line(NominalWarning("beyond\nits limits"), NominalWarning, "main.py", 7) == "warning: beyond its limits\n"
    assert line(UserWarning("odd"), UserWarning, "other.py", 7).startswith("other.py:7: UserWarning: odd")

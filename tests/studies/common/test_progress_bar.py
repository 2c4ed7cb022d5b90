"""Bars: lines without a terminal, one output of a cell in a notebook, a bar in a terminal."""

import sys
import types

import pytest

from pliant.studies import progress_bar


def work(title="chart <1>"):
    with progress_bar(title) as told:
        for share in (0.0, 0.001, 0.05, 0.5, 0.5, 1.0):
            told(share, "a & b")


def test_without_a_terminal_a_line_for_each_tenth(capsys):
    work("chart")
    lines = capsys.readouterr().err.splitlines()
    assert lines == [f"chart {share:3d} %  a & b" for share in (0, 50, 100)]


class Shell:
    kernel = "a notebook's"


class Display:
    """What IPython.display has of these, kept."""

    def __init__(self):
        self.kept = []

    def HTML(self, text):
        return text

    def display(self, text, display_id):
        assert display_id
        self.kept.append(text)
        return self

    def update(self, text):
        self.kept.append(text)


def test_in_a_notebook_one_output_that_is_written_anew(monkeypatch, capsys):
    """For each per cent or new words: 0, 0 with words, 5, 50, 100."""
    there = Display()
    module = types.SimpleNamespace(get_ipython=lambda: Shell(), display=there)
    monkeypatch.setitem(sys.modules, "IPython", module)
    work()
    assert len(there.kept) == 5 and capsys.readouterr() == ("", "")
    assert there.kept[-1] == "chart &lt;1&gt; <progress max='100' value='100'></progress> 100 % a &amp; b"


def test_ipython_in_a_terminal_is_no_notebook(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: object(), display=None))
    work()
    assert capsys.readouterr().err


def test_in_a_terminal_a_bar(monkeypatch, capsys):
    monkeypatch.setenv("FORCE_COLOR", "1")
    work("chart")
    assert "━" in capsys.readouterr().err


def test_a_title_is_text():
    with pytest.raises(ValueError, match=r"progress_bar.title = 3 must be"):
        progress_bar(3)

"""One style whatever the caller's own settings; no matplotlib before something is drawn."""

import subprocess
import sys

import matplotlib
import pytest

from pliant.studies.figures.style import COLOURS, INK, inline, panels, save, styled


@styled
def drawn():
    figure, (ax,) = panels(1)
    for _ in range(2):
        ax.plot([0, 1])
    return figure


def test_colours_are_the_styles_own_whatever_the_caller_has_set():
    before = matplotlib.rcParams["axes.prop_cycle"]
    with matplotlib.rc_context({"axes.prop_cycle": matplotlib.cycler(color=["red"])}):
        assert [line.get_color() for line in drawn().axes[0].lines] == list(COLOURS[:2])
    assert matplotlib.rcParams["axes.prop_cycle"] == before


def test_saved_as_its_ending_says(tmp_path):
    figure = drawn()
    for ending, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        save(figure, tmp_path / f"f.{ending}")
        assert (tmp_path / f"f.{ending}").read_bytes().startswith(start)
    with pytest.raises(ValueError, match=r"'f\.xyz' must end with one of"):
        save(figure, "f.xyz")


def test_inlined_in_the_pages_own_colour():
    text = inline(drawn())
    assert text.startswith("<svg") and "currentColor" in text and INK not in text
    assert "xmlns" not in text and "<metadata>" not in text and " width=" not in text[: text.index(">")]


@pytest.mark.campaign
def test_importing_every_figure_loads_no_matplotlib():
    code = (
        "import sys, pkgutil, importlib, pliant.studies.figures as f, pliant.studies.papers as p\n"
        "for room in (f, p):\n"
        "    for m in pkgutil.iter_modules(room.__path__): importlib.import_module(f'{room.__name__}.{m.name}')\n"
        "sys.exit(any(m in sys.modules for m in ('matplotlib', 'control', 'rich', 'torch')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

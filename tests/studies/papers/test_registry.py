"""The figures of the papers, written by name."""

import pytest

from pliant.studies.figures.style import panels
from pliant.studies.papers import draw, registry


def test_every_paper_is_drawn_by_a_function():
    assert set(registry.DRAWN) == set(registry.PAPERS)
    with pytest.raises(ValueError, match=r"figures\.paper = 'nature' must be one of"):
        draw("nature")


def test_written_as_png_with_progress(tmp_path, monkeypatch):
    monkeypatch.setitem(registry.DRAWN, "single-link", lambda: {"one": panels(1)[0], "two": panels(1)[0]})
    seen = []
    files = registry.write("single-link", tmp_path / "new", lambda fraction, _: seen.append(fraction))
    assert [f.name for f in files] == ["one.png", "two.png"] and seen == sorted(seen) and seen[-1] == 1.0
    assert all(f.read_bytes().startswith(b"\x89PNG") for f in files)

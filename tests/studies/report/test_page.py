"""The page around the sections."""

import re
from types import SimpleNamespace

from pliant.studies.report import page


def test_every_section_has_its_link_and_words_are_escaped(monkeypatch):
    monkeypatch.setattr(page.sections, "all_of", lambda *_: [("The answer", "<p>42</p>"), ("Versions", "")])
    scene = SimpleNamespace(name="slew <1>", about="a & b")
    text = page.build(SimpleNamespace(scene=scene, machine={"pliant": "0.2"}, seconds=31.4), {})
    assert (
        re.findall(r'href="#([^"]*)"', text) == re.findall(r'section id="([^"]*)"', text) == ["the-answer", "versions"]
    )
    assert "slew &lt;1&gt;" in text and "a &amp; b" in text and "Made by Pliant 0.2 in 31 s." in text
    assert "<style>" in text and "<script>" in text and "<p>42</p>" in text

"""Two reports on one page: what differs is marked, and the folder appears whole or not at all."""

import json
import re
import sys

import pytest

from pliant.envs import scenes
from pliant.studies.report.comparison import compare_reports

SHORT, LONG = (scenes.get("single-link-slew", duration=duration) for duration in (1.5, 2.0))
ANSWERS = {1.5: [("model", "rigid"), ("costs", "LQR 3.5")], 2.0: [("model", "rigid"), ("its error", "1 mm")]}


@pytest.fixture
def reports(monkeypatch):
    """Reports that take no time."""

    def report(scene, out, *, progress, budget):
        out.mkdir()
        (out / "report.html").write_text("whole")
        (out / "motion.png").write_bytes(b"png")
        (out / "report.json").write_text(json.dumps({"answer": ANSWERS[scene.duration], "files": []}))
        progress(1.0, "report")

    monkeypatch.setattr(sys.modules["pliant.studies.report.comparison"], "report", report)


def test_answers_stand_side_by_side_and_what_differs_is_marked(reports, tmp_path):
    told = []
    page = compare_reports(SHORT, LONG, tmp_path / "two", labels=("a", "b <3>"), progress=lambda s, _: told.append(s))
    text = page.read_text(encoding="utf-8")
    rows = re.findall(r"<tr( class=\"marked\")?>((?:<td[^>]*>[^<]*</td>)+)</tr>", text)
    cells = [(bool(mark), *re.findall(r"<td[^>]*>([^<]*)</td>", row)) for mark, row in rows]
    assert cells == [
        (False, "model", "rigid", "rigid"),
        (True, "costs", "LQR 3.5", "–"),
        (True, "its error", "–", "1 mm"),
    ]
    assert "b &lt;3&gt;" in text and "<3>" not in text and 'href="second/report.html"' in text
    assert re.findall(r'<img src="([^"]*)"', text) == ["first/motion.png", "second/motion.png"] and told == [0.5, 1.0]
    assert compare_reports(SHORT, LONG, tmp_path / "two") == page  # a former one is replaced
    kept = json.loads((tmp_path / "two" / "report.json").read_text())
    assert kept["compared"] == ["single-link-slew", "single-link-slew"] and len(kept["answers"]) == 2


def test_other_files_are_not_replaced(reports, tmp_path):
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(ValueError, match="must be absent, empty or a former report"):
        compare_reports(SHORT, LONG, tmp_path)
    with pytest.raises(ValueError, match=r"compare_reports\.second"):
        compare_reports(SHORT, "heavy", tmp_path / "two")

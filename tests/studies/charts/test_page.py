"""A chart's page: every marker's setting under the pointer, by the marker's id; page, picture and table as one."""

import json
import re

import pytest
from made_up_charts import UNSTABLE, made_up_chart

from pliant.studies.charts import page
from pliant.studies.figures import style
from pliant.studies.figures.speed_accuracy import speed_accuracy
from pliant.studies.peers.peer_rows import PeerRow

FOUND = made_up_chart()


@pytest.fixture(scope="module")
def text():
    return page.build(FOUND, style.inline(speed_accuracy(FOUND)), "A scene.")


def test_each_marker_has_its_words(text):
    told = json.loads(re.search(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)[1])
    drawn = set(re.findall(r'id="((?:row|fail|peer)-\d+)"', text))
    assert drawn and drawn <= set(told) and {"row-0", "fail-5", "peer-0"} <= drawn
    assert (
        told["row-7"]["lines"][:3]
        == [
            "strain, 3 (4 states)",
            "stepper, rk4, 2 ms, 1,024 lanes, double",
            "0.1 ms per simulated second, and lane",
        ]
        or told["row-7"]["lines"][2] == "0.1 ms per simulated second and lane"
    )
    assert told["fail-5"]["lines"][-1] == UNSTABLE
    assert told["peer-0"]["lines"][:2] == ["Other, chain", "20 links, 1 ms"]
    assert "the model took 20 ms per simulated second to make" in told["row-10"]["lines"]


def test_it_needs_no_network(text):
    assert text.count("<script>") == 1 and not re.search(r'(src|href)="?https?:', text)
    assert "Other programs on the same motion" in text and "not installed: pip install third" in text


def test_how_far_other_programs_are_behind():
    assert page.beside(FOUND) == (
        "Other, chain: 50 times, where it errs by 0.5 mm; 500 times or more beside each of 1,024 at once."
    )
    more = (*FOUND.peers, PeerRow("Other, chain", "fast", 4e-4, 3e-2, 3, 12))
    said = page.beside(made_up_chart(peers=more))
    assert said.startswith("Other, chain: 4 to 50 times, least where it errs by 30 mm; 400 times or more beside")
    assert page.beside(made_up_chart(peers=FOUND.peers[1:])) == ""


def test_what_it_comes_to():
    said = page.sentence(FOUND)
    assert said.startswith("The fastest within 1 mm of physics. One motion: strain, 3 by stepper, rk4, 2 ms, 1 lane")
    assert "1,024 at once: strain, 3 by stepper, rk4, 2 ms, 1,024 lanes, double, 0.1 ms" in said
    none = page.sentence(made_up_chart(tolerance=1e-9))
    assert none == "Nothing that was measured is shown to keep < 0.01 µm; settings not run for want of time: 1."


def test_three_files_named_after_the_scene(tmp_path):
    files = page.save_all(FOUND, tmp_path, mark=FOUND.fastest())
    assert [path.name for path in files] == ["made-up.html", "made-up.png", "made-up.json"]
    assert all(path.stat().st_size > 1000 for path in files) and len(list(tmp_path.iterdir())) == 3
    assert json.loads(files[2].read_text())["scene"] == "made-up"


def test_none_of_them_where_one_cannot_be_written(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "build", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        page.save_all(FOUND, tmp_path)
    assert not list(tmp_path.iterdir())

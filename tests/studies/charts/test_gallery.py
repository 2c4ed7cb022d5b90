"""Many scenes in one folder: an index, nothing measured twice, a scene that fails told."""

import pytest
from made_up_charts import made_up_chart

from pliant.studies.charts import gallery as room
from pliant.studies.charts.gallery import counted, gallery, index
from pliant.studies.common import machine
from pliant.studies.physics.quasi_linear import NotSettled

NAMES = ("spin-up", "two-link-reach")


@pytest.fixture
def asked(monkeypatch):
    seen = []

    def chart(scene, **options):
        seen.append((scene.name, options["kept"].name))
        if scene.name == "spin-up" and len(seen) > 3:
            raise NotSettled("lost")
        return made_up_chart(scene=scene.name, machine=machine.describe(), budget=options["budget"])

    def save_all(found, folder, **_):  # as `page` does, without the time that drawing takes
        for ending in (".html", ".png"):
            (folder / f"{found.scene}{ending}").touch()
        found.save(folder / f"{found.scene}.json")

    monkeypatch.setattr(room, "chart", chart)
    monkeypatch.setattr(room, "save_all", save_all)
    return seen


def test_what_is_there_is_not_measured_again(asked, tmp_path):
    found = gallery(tmp_path, scenes=NAMES, budget=2.0)
    assert [c.scene for c in found] == list(NAMES)
    assert asked == [(name, f"{name}.rows.jsonl") for name in NAMES]
    names = {f"{name}{ending}" for name in NAMES for ending in (".html", ".png", ".json")}
    assert {p.name for p in tmp_path.iterdir()} == {*names, "index.html"}
    text = (tmp_path / "index.html").read_text()
    assert all(f'<a href="{name}.html"><img src="{name}.png"' in text for name in NAMES)
    (tmp_path / "two-link-reach.json").unlink()
    assert gallery(tmp_path, scenes=NAMES, budget=2.0) == found
    assert [name for name, _ in asked[2:]] == ["two-link-reach"]
    gallery(tmp_path, scenes=NAMES, budget=3.0)  # more is asked for
    assert len(asked) == 5
    assert "NotSettled: lost" in (tmp_path / "index.html").read_text()


def test_in_numbers():
    scene, variants, methods, measured, failed, not_run, known, share = counted(made_up_chart())
    assert (scene, variants, methods, measured, failed, not_run) == ("made-up", 2, 2, 7, 2, 2)
    assert known == "20 µm" and share == pytest.approx(2.0)
    assert "made-up" in index([made_up_chart()]) and "Speed against accuracy" in index([])


def test_bad_arguments(tmp_path):
    with pytest.raises(ValueError, match=r"gallery.scenes\[0\] = 'none'"):
        gallery(tmp_path, scenes=("none",))
    with pytest.raises(ValueError, match=r"gallery.budget = 0"):
        gallery(tmp_path, budget=0)

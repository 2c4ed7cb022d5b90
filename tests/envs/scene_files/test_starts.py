import sys

import pytest

from pliant.envs import scenes
from pliant.envs.scene_files.own_modules import import_file
from pliant.envs.scene_files.scene_tables import from_tables
from pliant.envs.scene_files.starts import plant_start, scene_start
from pliant.plants import check
from pliant.plants.files.toml_text import loads
from pliant.plants.tables import plant_types


@pytest.fixture
def crane(tmp_path, monkeypatch):
    """The plant and the scene that `pliant new plant` writes."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(plant_types, "_registered", {})
    for file, text in plant_start("my-first-crane").items():
        (tmp_path / file).write_text(text)
    import_file(tmp_path / "my_first_crane.py")
    yield scenes.load(tmp_path / "my-first-crane.toml")
    sys.modules.pop("my_first_crane", None)


def test_a_started_plant_is_sound_in_at_most_60_lines_and_its_scene_plays(crane):
    """A pendulum on a trolley: with the trolley held it swings at sqrt(g / l) (any textbook)."""
    check(crane.plant)
    assert len(plant_start("crane")["crane.py"].splitlines()) <= 60
    assert crane.plant.natural_frequencies(locked=("trolley_x",)) == pytest.approx([(9.81 / 3.0) ** 0.5], rel=1e-12)
    assert type(crane.plant).__name__ == "MyFirstCrane" and crane.target[0][0] == 2.0


def test_a_started_scene_is_its_base_and_stays_it_with_every_comment_taken_away():
    ((name, text),) = scene_start("far-reach").items()
    base = scenes.get("two-link-reach")
    assert name == "far-reach.toml" and loads(text)["base"] == "two-link-reach"
    whole = "\n".join(line.removeprefix("# ") for line in text.splitlines()[1:])
    for tables in (loads(text), loads(whole)):
        made = from_tables(tables)
        assert made.plant == base.plant and made.goal == base.goal and made.name == "far-reach"


@pytest.mark.parametrize("start", [plant_start, scene_start])
def test_names_that_no_file_should_have_are_refused(start):
    with pytest.raises(ValueError, match=r"NAME = '\.\./up' must be words of a-z"):
        start("../up")
    with pytest.raises(ValueError, match="--base 'two' must be one of single-link-slew"):
        scene_start("a", "two")

"""A first scene of a plant that comes without one: it plays as it is written."""

import pytest
from hoist import Hoist

from pliant.envs import check_scene, scenes
from pliant.envs.scene_files.plant_scene import first_scene, written
from pliant.envs.scene_files.scene_tables import from_tables
from pliant.envs.scene_files.starts import scene_start
from pliant.plants import SingleLinkArm
from pliant.plants.files.toml_text import loads
from pliant.plants.tables import plant_types


@pytest.mark.parametrize("plant", [Hoist(mass=200.0), SingleLinkArm.textbook()])
def test_it_plays_and_its_file_is_it(plant, monkeypatch):
    monkeypatch.setattr(plant_types, "_registered", {"Hoist": Hoist})
    scene = first_scene("mine", plant)
    assert "environment" in dict(check_scene(scene).found)
    text = written(scene)
    assert from_tables(loads(text)) == scene and max(map(len, text.splitlines())) <= 120
    assert "put your machine's" in text


def test_limits_hold_what_the_rest_takes_too():
    """200 kg hang at 1962 N; twice that."""
    scene = first_scene("mine", Hoist(mass=200.0))
    assert scene.limits[0] == pytest.approx(2 * 200 * 9.81, rel=0.2) and scene.start == (("rope", 4.0), ("sway", 0.0))


def test_a_base_is_a_scene_a_file_or_a_type_of_plants(tmp_path, monkeypatch):
    monkeypatch.setattr(plant_types, "_registered", {"Hoist": Hoist})
    path = tmp_path / "first.toml"
    path.write_text(scene_start("first", "Hoist")["first.toml"])
    again = scene_start("second", str(path))["second.toml"]
    assert from_tables(loads(again)).limits == scenes.load(path).limits and 'name = "second"' in again
    assert 'base = "spin-up"' in scene_start("third", "spin-up")["third.toml"]
    with pytest.raises(ValueError, match="FlexibleTree must have a default for every field"):
        scene_start("fourth", "FlexibleTree")


def test_weights_and_efforts_are_of_squares():
    text = scene_start("far", "two-link-reach")["far.toml"]
    weights = text[text.index("# [weights]") : text.index("# [effort]")]
    assert "# theta1 = 10.0  # of its square [(rad)^2]" in weights and "# theta1 = -0.9  # [rad]" in text

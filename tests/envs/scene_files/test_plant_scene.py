"""A first scene of a plant that comes without one: it plays as it is written."""

import dataclasses
import math
import xml.etree.ElementTree as xml

import pytest
from hoist import Hoist

from pliant.envs import check_scene, scenes
from pliant.envs.machines.trees import SIX_AXIS
from pliant.envs.scene_files.plant_scene import first_scene, written
from pliant.envs.scene_files.scene_tables import from_tables
from pliant.envs.scene_files.starts import scene_start
from pliant.plants import ElasticJoint, FlexibleTree, Joint, SingleLinkArm, TreeBody
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


def test_a_robots_file_gives_its_own_limits_and_a_motion_within_its_joints_ranges():
    """What the URDF says: effort 150, 150, 150, 28, 28, 28 N m; the start clear of a range that leaves zero out."""
    robot = xml.parse(SIX_AXIS).getroot()
    efforts = [float(limit.get("effort")) for limit in robot.iter("limit")]
    ((name, text),) = scene_start("pick", str(SIX_AXIS)).items()
    scene = from_tables(loads(text))
    assert name == "pick.toml" and list(scene.limits) == efforts and "6 joints" in scene.about
    bent = dataclasses.replace(scene.plant.bodies[2].joint, lower=0.2, upper=1.0)
    bodies = list(scene.plant.bodies)
    bodies[2] = dataclasses.replace(bodies[2], joint=bent)
    moved = first_scene("bent", dataclasses.replace(scene.plant, bodies=tuple(bodies)))
    assert dict(moved.start)["elbow"] == 0.4 and dict(moved.goal)["elbow"] == 0.6


@pytest.mark.parametrize(("stiffness", "period"), [(1e2, 0.02), (4e3, 0.01), (1e4, 0.005), (1e6, 0.001)])
def test_the_control_period_samples_the_slowest_vibration_ten_times(stiffness, period):
    """A motor behind an elastic gear, both sides free: w^2 = k (1/J + 1/(n^2 J_m)); rounded down to 1, 2 or 5."""
    gear = ElasticJoint(rotor_inertia=1e-3, ratio=50.0, stiffness=stiffness)
    link = TreeBody(name="link", joint=Joint(name="hub", elastic=gear), mass=1.0, inertia=2.0)
    tree = FlexibleTree(bodies=(link,), gravity=(0, 0, 0))
    w = (stiffness * (1 / 2.0 + 1 / 2.5)) ** 0.5
    assert first_scene("sprung", tree).dt == period <= max(0.2 * math.pi / w, 1e-3)


def test_an_effort_whose_square_no_number_holds_is_none():
    """As one of zero: the limit is what the motion takes."""
    link = TreeBody(name="link", joint=Joint(name="hub", effort=1e-170), mass=1.0, inertia=2.0)
    scene = first_scene("still", FlexibleTree(bodies=(link,), gravity=(0, 0, 0)))
    assert scene.limits[0] > 1e-3

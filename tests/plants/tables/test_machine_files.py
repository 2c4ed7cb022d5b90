"""A machine's own file: which it is, and the plant that it holds."""

import pytest

from pliant.envs.machines.trees import SIX_AXIS
from pliant.plants import FlexibleTree
from pliant.plants.tables.machine_files import is_machine, read


def test_a_urdf_and_the_toml_of_its_tree_are_the_same_machine(tmp_path):
    robot, kept = FlexibleTree.from_urdf(SIX_AXIS), tmp_path / "arm.toml"
    robot.to_toml(kept)
    assert is_machine(SIX_AXIS) and is_machine(str(kept))
    assert read(str(SIX_AXIS)) == read(kept) == robot


def test_scenes_and_names_are_no_machines(tmp_path):
    scene = tmp_path / "slew.toml"
    scene.write_text('name = "slew"\nbase = "two-link-reach"\n')
    assert not any(is_machine(name) for name in (scene, str(scene), "two-link-reach", tmp_path / "none.toml", 3))


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"path = '.*no\.urdf' must be a file that can be read"):
        read(tmp_path / "no.urdf")
    with pytest.raises(ValueError, match=r"machine is a int, must be a path"):
        read(3)

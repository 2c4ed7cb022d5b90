"""Trees in TOML files: what is written comes back equal; what is wrong is told by file, key, value and range."""

import pickle

import numpy as np
import pytest

from pliant.envs.machines import trees
from pliant.plants import FlexibleTree

MACHINES = ("flexible_joint", "six_axis", "three_link", "crane", "satellite_arm")
HAND = """
gravity = [0.0, 0.0, 0.0]
[[bodies]]
name = "link"
joint = {name = "hub", damping = 0.1}
modes = [2, 0, 0, 0]
[bodies.beam]
make = "rectangular"
length = 1.0
width = 0.05
depth = 0.005
material = {type = "Material", density = 7850.0, E = 210e9, G = 81e9}
"""


@pytest.mark.parametrize("name", MACHINES)
def test_a_written_tree_comes_back_equal(name: str, tmp_path) -> None:
    tree, file = getattr(trees, name)(), tmp_path / "tree.toml"
    tree.to_toml(file)
    assert FlexibleTree.from_toml(file) == tree and hash(FlexibleTree.from_toml(file)) == hash(tree)
    assert pickle.loads(pickle.dumps(FlexibleTree.from_toml(file))) == tree


def test_a_tree_written_by_hand_is_the_machine(tmp_path) -> None:
    """3.516^2 E I / (m L^3): its link clamped, the first frequency of a cantilever, by two polynomials within 0.5 %."""
    file = tmp_path / "arm.toml"
    file.write_text(HAND)
    arm = FlexibleTree.from_toml(file)
    beam = arm.bodies[0].beam
    first = arm.natural_frequencies(np.zeros(arm.nx), locked=("hub",))[0]
    assert first == pytest.approx(3.516 * np.sqrt(beam.E * beam.I_z / (beam.mass * beam.length**3)), rel=5e-3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("damping = 0.1", "damping = -0.1", ("tree.bodies[0].joint", "damping = -0.1", ">= 0")),
        ("damping = 0.1", 'damping = "much"', ("damping", "much")),
        ('name = "hub"', 'name = "hub", axes = 1', ("joint.axes = 1", "must be one of")),
        ("modes = [2, 0, 0, 0]", "modes = [2, 0]", ("modes", "(2, 0)", "4")),
        ("modes = [2, 0, 0, 0]", "modes = [99, 0, 0, 0]", ("modes", "99", "12")),
        ("length = 1.0", "length = 0.0", ("length = 0.0", "> 0")),
        ("length = 1.0\n", "", ("beam lacks length",)),
        ("density = 7850.0", "density = nan", ("density = nan",)),
        ('make = "rectangular"', 'make = "system"', ("make = 'system'", "rectangular")),
        ('type = "Material"', 'type = "os.system"', ("type = 'os.system'", "must be one of")),
        ("gravity = [0.0, 0.0, 0.0]", "gravity = [0.0, 0.0]", ("gravity",)),
        ("gravity = [0.0, 0.0, 0.0]", 'type = "TwoLinkArm"', ("tree",)),
        ("gravity = [0.0, 0.0, 0.0]", "gravity = [", ("line",)),
        ("[[bodies]]", "[[body]]", ("tree.body", "must be one of")),
        ('name = "link"', 'name = "link"\nparent = "hand"', ("parent = 'hand'", "must be a body before it")),
    ],
)
def test_what_is_wrong_is_told(old: str, new: str, words: tuple[str, ...], tmp_path) -> None:
    file = tmp_path / "arm.toml"
    assert old in HAND
    file.write_text(HAND.replace(old, new))
    with pytest.raises(ValueError) as told:
        FlexibleTree.from_toml(file)
    assert all(word in str(told.value) for word in (str(file), *words)) and "\n" not in str(told.value)


def test_no_file_and_no_path_are_told(tmp_path) -> None:
    with pytest.raises((ValueError, OSError), match=r"none\.toml"):
        FlexibleTree.from_toml(tmp_path / "none.toml")
    with pytest.raises(ValueError, match=r"from_toml\.path is a int"):
        FlexibleTree.from_toml(3)

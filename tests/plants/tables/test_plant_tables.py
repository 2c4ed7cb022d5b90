import dataclasses

import casadi as ca
import pytest

from pliant.envs import scenes
from pliant.plants import Beam, FlexibleTree, Joint, Material, SingleLinkArm, TreeBody, TwoLinkArm
from pliant.plants.files.toml_text import dumps, loads
from pliant.plants.tables.plant_tables import from_table, to_table

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=Material(density=2700.0, E=7e10, G=2.6e10))
TREE = FlexibleTree.serial(
    [
        TreeBody(name="post", joint=Joint(name="shoulder", damping=0.1), beam=STRIP, modes=(2, 1, 0, 0)),
        TreeBody(
            name="hand", joint=Joint(name="wrist", axis=(0.0, 1.0, 0.0), lower=-1.0, upper=1.0), mass=0.5, inertia=0.01
        ),
    ]
)


@pytest.mark.parametrize("plant", [*(scenes.get(name).plant for name in scenes.SCENES), TREE], ids=lambda p: p.label)
def test_a_plant_comes_back_equal(plant):
    """Equal in every field and of the same hash, by way of a text."""
    found = from_table(loads(dumps({"plant": to_table(plant)}))["plant"])
    assert found == plant and hash(found) == hash(plant)
    assert repr(found) == repr(plant)


def test_makers_take_what_they_know_and_the_rest_is_replaced():
    material = {"type": "Material", "density": 2700.0, "E": 7e10, "G": 2.6e10}
    link = {"make": "rectangular", "length": 1, "width": 0.04, "depth": 0.008, "material": material, "damping": 2e-4}
    found = from_table({"type": "TwoLinkArm", "make": "textbook", "link1": link, "gravity": 0, "modes": [1, 1]})
    textbook = TwoLinkArm.textbook()
    assert found == dataclasses.replace(
        textbook, link1=dataclasses.replace(STRIP, damping=2e-4), gravity=0.0, modes=(1, 1)
    )


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({}, "plant lacks type, must name the plant"),
        ({"type": "Twolink"}, "plant.type = 'Twolink' must be one of SingleLinkArm"),
        ({"type": 3}, "plant.type = 3 must be words"),
        ({"type": "TwoLinkArm"}, "plant lacks link1, link2"),
        ({"type": "TwoLinkArm", "make": "from_urdf"}, "plant.make = 'from_urdf' must be one of 'textbook'"),
        ({"type": "TwoLinkArm", "make": "textbook", "gravty": 1}, "plant.gravty = 1: .* must be one of link1"),
        ({"type": "TwoLinkArm", "make": "textbook", "link1": 3}, "plant.link1 = 3 must be a table, a Beam"),
        ({"type": "TwoLinkArm", "make": "textbook", "payload": {"mass": -1}}, r"plant.payload: Payload.mass = -1 must"),
        ({"type": "TwoLinkArm", "make": "textbook", "link1": {"type": "os"}}, "plant.link1.type = 'os' must be one of"),
        ({"type": "TwoLinkArm", "make": "textbook", "tip_slope": 3}, "tip_slope = 3 must be True or False"),
        (
            {"type": "TwoLinkArm", "make": "textbook", "gravity": {}},
            r"plant.gravity = \{\} must be a number, not a table",
        ),
        ({"type": "SingleLinkArm", "link": {"make": "tube", "length": 1}}, "plant.link lacks outer, inner, material"),
    ],
)
def test_a_table_that_makes_no_plant_is_refused_by_key_and_value(table, words):
    with pytest.raises(ValueError, match=words):
        from_table(table)


def test_an_expression_is_not_written():
    arm = dataclasses.replace(SingleLinkArm.textbook(), hub_inertia=ca.SX.sym("J"))
    with pytest.raises(ValueError, match=r"plant.hub_inertia = .* cannot be written"):
        to_table(arm)

"""Which joints must move something; refusals in words: test_bad_trees.py."""

import dataclasses

import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody

ARM = TreeBody(name="a", joint=Joint(name="ja"), mass=1.0, inertia=0.1)
EMPTY = TreeBody(name="b", joint=Joint(name="jb"))


def given(**joint):
    return dataclasses.replace(EMPTY, joint=Joint(name="jb", **joint))


@pytest.mark.parametrize(
    "bodies",
    [
        (ARM, given(drive="acceleration")),
        (ARM, given(armature=0.01)),
        (ARM, given(kind="fixed")),
        (EMPTY, ARM),
        (ARM, EMPTY, dataclasses.replace(ARM, name="c", joint=Joint(name="jc", kind="fixed"))),
    ],
)
def test_taken(bodies):
    assert FlexibleTree(bodies=bodies).nx >= 2


def test_a_payload_is_carried():
    with pytest.raises(ValueError, match=r"bodies\[1\]\.mass = 0\.0 of body 'b'"):
        FlexibleTree(bodies=(ARM, EMPTY))
    FlexibleTree(bodies=(ARM, EMPTY), payload=Payload(mass=1.0, inertia=0.1))
    with pytest.raises(ValueError, match=r"bodies\[1\]\.mass = 0\.0 of body 'b'"):
        FlexibleTree(bodies=(ARM, EMPTY), payload=Payload(mass=1.0, inertia=0.1), tip="a")


def test_masses_that_vary_may_be_zero_in_name_alone():
    assert FlexibleTree(bodies=(ARM,)).vary("bodies.0.mass", "bodies.0.inertia").dynamics([0, 0]).shape == (2,)

"""What a tree refuses, and its signals."""

import numpy as np
import pytest

from pliant.plants import FlexibleTree, Frame, Joint, TreeBody

A = TreeBody(name="a", joint=Joint(name="ja"), mass=1.0, inertia=0.1)
B = TreeBody(name="b", joint=Joint(name="jb"), parent="a", mass=1.0, inertia=0.1)
TABLE = {
    "no bodies": ({"bodies": ()}, r"FlexibleTree\.bodies = \(\) must be one body at least"),
    "not bodies": ({"bodies": (1,)}, r"FlexibleTree\.bodies\[0\] = 1 must be a TreeBody"),
    "body twice": ({"bodies": (A, A)}, r"FlexibleTree\.bodies\[1\] = 'a' must have a name of its own"),
    "joint twice": (
        {"bodies": (A, TreeBody(name="c", joint=Joint(name="ja")))},
        r"FlexibleTree\.bodies\[1\] = 'ja' must have a name of its own",
    ),
    "child first": (
        {"bodies": (B, A)},
        r"\.bodies\[0\]\.parent = 'a' of body 'b' must be a body before it",
    ),
    "no frame's body": (
        {"frames": (Frame(name="f", body="c"),)},
        r"FlexibleTree\.frames\[0\]\.body = 'c' of frame 'f' must be one of a, b, base",
    ),
    "frame twice": (
        {"frames": (Frame(name="f", body="a"), Frame(name="f", body="b"))},
        r"FlexibleTree\.frames\[1\]\.name = 'f' must be a name of its own",
    ),
    "frame called tip": (
        {"frames": (Frame(name="tip", body="a"),)},
        r"\[0\]\.name = 'tip' must be a name of",
    ),
    "tip": ({"tip": "hand"}, r"FlexibleTree\.tip = 'hand' must be a body or a frame"),
    "loads": ({"loads": ("hand",)}, r"FlexibleTree\.loads\[0\] = 'hand' must be one of tip"),
    "gravity": ({"gravity": 9.81}, r"FlexibleTree\.gravity = 9\.81 must be three numbers \[m/s\^2\]"),
    "base": ({"base": "floating"}, r"FlexibleTree\.base = 'floating' must be one of 'fixed', 'free', 'driven'"),
    "a free base without mass": (
        {"base": "free"},
        r"FlexibleTree\.platform\.mass = 0\.0 must be > 0 \[kg\] where base = 'free'",
    ),
    "base freedoms": (
        {"base": "driven", "base_freedoms": ("x", "roll")},
        r"FlexibleTree\.base_freedoms\[1\] = 'roll': no such freedom; choose from x, y",
    ),
    "no base freedoms": ({"base": "driven", "base_freedoms": ()}, r"base_freedoms = \(\) must name one freedom at"),
    "basis": ({"basis": "payload"}, r"FlexibleTree\.basis = 'payload' must be one of"),
    "payload": ({"payload": 1.0}, r"FlexibleTree\.payload = 1\.0 must be a Payload"),
    "nothing moves": (
        {"bodies": (TreeBody(name="a", joint=Joint(name="ja", kind="fixed"), mass=1.0),)},
        r"FlexibleTree\.bodies = \('a',\) must have a joint that moves",
    ),
}


@pytest.mark.parametrize("name", TABLE)
def test_refused(name):
    changes, words = TABLE[name]
    with pytest.raises(ValueError, match=words):
        FlexibleTree(**({"bodies": (A, B)} | changes))


def test_signals(space):
    tree = space()
    assert [s.name for s in tree.coordinates] == [
        *("j1", "j2", "j3", "j4"),
        *("upper_y1", "upper_y2", "upper_z1", "upper_twist1", "upper_stretch1"),
        *("fore_y1", "fore_z1", "fore_z2", "fore_twist1"),
    ]
    assert [s.name for s in tree.inputs] == ["j1_torque", "j2_torque", "j3_force", "j4_torque"]
    assert tree.inputs[2].unit == "N"
    assert tree.disturbances[0].name == "tip_force_x"
    assert tree.disturbances[9].name == "middle_torque_x"
    assert len(tree.outputs) == tree.measure(np.zeros(tree.nx)).shape[0]


def test_a_frame_may_be_the_tip():
    frame = Frame(name="tool", body="a", position=(1, 0, 0))
    tree = FlexibleTree(bodies=(A, B), frames=(frame,), tip="tool")
    names = [s.name for s in tree.outputs]
    assert tree.measure(np.zeros(4))[names.index("tip_x")] == 1.0

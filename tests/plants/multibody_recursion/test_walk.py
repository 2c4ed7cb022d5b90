"""The ways between frames take the steps that they need, no more."""

import casadi as ca
import numpy as np

from pliant.plants import FlexibleTree, Joint, TreeBody
from pliant.plants.multibody_parts.steps import Fixed, Move, Spin


def steps(tree, k=0):
    n = len(tree.coordinates)
    return tree._walk(ca.SX.sym("q", n), ca.SX.sym("v", n)).edges[k].steps


def body(**joint):
    return TreeBody(name="b", joint=Joint(name="j", **joint), mass=1.0, inertia=0.1)


def test_steps():
    assert [type(s) for s in steps(FlexibleTree.serial([body()]))] == [Spin]
    assert [type(s) for s in steps(FlexibleTree.serial([body(position=(1, 0, 0))]))] == [Move, Spin]
    assert [type(s) for s in steps(FlexibleTree.serial([body(axis=(0, 0.6, 0.8))]))] == [Fixed, Spin, Fixed]
    assert [type(s) for s in steps(FlexibleTree.serial([body(kind="prismatic")]))] == [Move]


def test_an_axis_that_points_back():
    """A joint about -y turns as one about y does back: same mass, torque of the other sign, also from a turned base."""
    made = [
        FlexibleTree.serial(
            [body(axis=axis), TreeBody(name="c", joint=Joint(name="k", position=(1, 0, 0)), mass=1.0, inertia=0.2)]
        )
        for axis in ((0, 1, 0), (0, -1, 0))
    ]
    x = np.array([0.4, 0.7, 0.3, 0.2])
    back = x * [-1, 1, -1, 1]
    given, own = made[0].dynamics(x, [1.0, 0.5]), made[1].dynamics(back, [-1.0, 0.5])
    np.testing.assert_allclose(own, given * [-1, 1, -1, 1], atol=1e-12)


def test_keys(space):
    tree = space()
    n = len(tree.coordinates)
    walk = tree._walk(ca.SX.sym("q", n), ca.SX.sym("v", n))
    assert list(walk.joint_keys) == [0, 1, 2, 3]
    assert [len(r) for r in walk.beam_keys.values()] == [5, 4]

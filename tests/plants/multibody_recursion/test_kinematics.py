"""Places and speeds of nodes of a machine that can be drawn on paper."""

import casadi as ca
import numpy as np

from pliant.plants import FlexibleTree, Frame, Joint, TreeBody
from pliant.plants.multibody_recursion.kinematics import drawn, poses, twists, weight_energy

BODIES = [
    TreeBody(name="a", joint=Joint(name="a", axis=(0, 0, 1)), mass=2.0, centre=(0.5, 0, 0), inertia=0.1),
    TreeBody(name="b", joint=Joint(name="b", axis=(0, 1, 0), position=(1, 0, 0)), mass=1.0, inertia=0.1),
]
TREE = FlexibleTree.serial(BODIES, frames=(Frame(name="eye", body="b", position=(0.5, 0, 0)),))


def walk(q, v):
    return TREE._walk(ca.SX(ca.DM(q)), ca.SX(ca.DM(v)))


def test_poses_and_twists():
    at = walk([np.pi / 2, np.pi / 2], [2.0, 0.0])
    k = TREE.tree.places["eye"]
    pose, twist = poses(at)[k], twists(at)[k]
    np.testing.assert_allclose(np.array(ca.DM(pose.p)).ravel(), [0, 1, -0.5], atol=1e-14)
    velocity = np.array(ca.DM(pose.R @ twist.v)).ravel()
    np.testing.assert_allclose(velocity, [-2.0, 0, 0], atol=1e-14)
    np.testing.assert_allclose(np.array(ca.DM(pose.R @ twist.omega)).ravel(), [0, 0, 2.0], atol=1e-14)


def test_weight():
    g = ca.SX(ca.DM([0, 0, -10.0]))
    at = walk([0.3, 0.4], [0, 0])
    assert abs(float(weight_energy(at, g))) < 1e-14  # all mass is at the height of the base


def test_lines():
    """To the second body, to the eye: the tip is where that body is."""
    lines = [np.array(ca.DM(line)).T for line in drawn(walk([np.pi / 2, 0.0], [0, 0]), 3)]
    np.testing.assert_allclose(lines[0], [[0, 0, 0], [0, 0.5, 0], [0, 1, 0]], atol=1e-14)
    assert len(lines) == 2


def test_as_many_lines_at_every_state():
    """A slider at its parent's place keeps its line, of no length; of two places in one there is one line."""
    slide = TreeBody(name="c", joint=Joint(name="c", kind="prismatic", axis=(1, 0, 0)), mass=1.0)
    arm = TreeBody(name="d", joint=Joint(name="d", axis=(0, 1, 0)), mass=1.0, centre=(0, 0, -1), inertia=0.1)
    hook = [Frame(name=name, body="d", position=(0, 0, -1)) for name in ("hook", "end")]
    crane = FlexibleTree.serial([slide, arm], frames=hook, tip="hook")
    for place in (0.0, 0.5):
        rail, rope = crane.lines([place, 0.0, 0, 0], 3)
        np.testing.assert_allclose(rail[[0, -1]], [[0, 0, 0], [place, 0, 0]], atol=1e-14)
        np.testing.assert_allclose(rope[[0, -1]], [[place, 0, 0], [place, 0, -1]], atol=1e-14)

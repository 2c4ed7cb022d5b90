"""Bodies that are fixed to rigid ones become part of them; what hangs on beams has a node of its own."""

import casadi as ca
import numpy as np

from pliant.plants import Beam, FlexibleTree, Frame, Joint, TreeBody, beams
from pliant.plants.multibody_recursion.layout import BASE, rigid_inertia, turned

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
FIXED = Joint(name="weld", kind="fixed", position=(0.5, 0, 0), rotation=(0, 0, np.pi / 2))


def test_roll_pitch_yaw():
    np.testing.assert_array_equal(turned((0, 0, np.pi / 2)), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_array_equal(turned((np.pi / 2, 0, 0)) @ [0, 1, 0], [0, 0, 1])


def test_merged():
    """Steiner: the welded part adds J + m d^2 about the joint."""
    part = TreeBody(name="part", joint=FIXED, mass=2.0, centre=(0.1, 0, 0), inertia=0.3)
    tree = FlexibleTree.serial([TreeBody(name="a", joint=Joint(name="a"), mass=1.0, inertia=0.2), part])
    assert [n.name for n in tree.tree.nodes] == ["a", "tip"]
    np.testing.assert_allclose(tree.mass_matrix(np.zeros(2)), [[0.2 + 0.3 + 2.0 * (0.5**2 + 0.1**2)]])


def test_on_a_beam():
    part = TreeBody(name="part", joint=FIXED, mass=2.0, inertia=0.3)
    tree = FlexibleTree.serial([TreeBody(name="a", joint=Joint(name="a"), beam=STRIP), part])
    assert [(n.name, n.parent, n.station) for n in tree.tree.nodes] == [
        ("a", BASE, None),
        ("part", 0, 1.0),
        ("tip", 1, None),
    ]


def test_a_place_on_the_base():
    frames = (Frame(name="wall", body="base", position=(1, 2, 3)),)
    tree = FlexibleTree.serial([TreeBody(name="a", joint=Joint(name="a"), mass=1.0, inertia=0.2)], frames=frames)
    np.testing.assert_array_equal(tree.measure(np.zeros(2))[-6:], [1, 2, 3, 0, 0, 0])


def test_rigid_inertia():
    own = rigid_inertia(2.0, (1.0, 0, 0), 0.3)
    P = np.array(ca.DM(own.matrix()))
    np.testing.assert_allclose(np.trace(P) * np.eye(3) - P, np.diag([0.3, 2.3, 2.3]))

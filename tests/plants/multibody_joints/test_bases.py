"""Bases that move: a driven one against the fixed base in a field of inertia, a free one against Newton's laws."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody

ARM = [
    TreeBody(name="a", joint=Joint(name="a", axis=(0, 1, 0)), mass=1.0, centre=(0.4, 0, 0), inertia=0.05),
    TreeBody(name="b", joint=Joint(name="b", axis=(0, 0, 1), position=(0.8, 0, 0)), mass=0.5, inertia=0.02),
]


def test_a_base_that_is_pushed_is_gravity_the_other_way():
    fixed = FlexibleTree.serial(ARM, gravity=(0.3, -0.2, -9.81))
    tree = FlexibleTree.serial(ARM, base="driven", base_freedoms=("x", "y", "z"), gravity=(0, 0, 0))
    assert [s.name for s in tree.states][:3] == ["base_x", "base_y", "base_z"]
    assert [s.name for s in tree.inputs] == [*(f"base_{c}_acceleration" for c in "xyz"), "a_torque", "b_torque"]
    x = np.array([0.3, -0.5, 0.7, 0.2])
    pushed = np.r_[np.zeros(3), x[:2], np.zeros(3), x[2:]]
    own = tree.dynamics(pushed, [-0.3, 0.2, 9.81, 0.1, 0.2])
    np.testing.assert_allclose(own[8:], fixed.dynamics(x, [0.1, 0.2])[2:], atol=1e-12)
    np.testing.assert_array_equal(own[5:8], [-0.3, 0.2, 9.81])


@pytest.mark.parametrize("turns", [("turn_z",), ("turn_x", "turn_y"), ("turn_x", "turn_y", "turn_z")])
def test_turns(turns):
    """The angular acceleration given about one axis is the same whichever other freedoms there are."""
    tree = FlexibleTree.serial(ARM, base="driven", base_freedoms=turns, gravity=(0, 0, 0))
    given = np.r_[np.zeros(len(turns)), 0.0, 0.0]
    given[len(turns) - 1] = 2.0
    axis = {1: (0, 0, 1), 2: (0, 1, 0), 3: (0, 0, 1)}[len(turns)]
    hinge = TreeBody(name="h", joint=Joint(name="h", axis=axis, drive="acceleration"))
    peer = FlexibleTree.serial([hinge, *ARM], gravity=(0, 0, 0))
    own, wanted = tree.dynamics(tree.rest_state, given), peer.dynamics(np.zeros(6), [2.0, 0, 0])
    np.testing.assert_allclose(own[-2:], wanted[-2:], atol=1e-12)


def test_a_free_body_falls_and_spins_by_euler():
    """J omega' = -omega x J omega about the mass centre, which falls: the base's origin moves about it."""
    J = np.array([[0.3, 0.02, 0.0], [0.02, 0.4, 0.01], [0.0, 0.01, 0.5]])
    bodies = [TreeBody(name="lid", joint=Joint(name="lid", kind="fixed"))]
    tree = FlexibleTree(
        bodies=tuple(bodies),
        base="free",
        platform=Payload(mass=2.0, inertia=tuple(map(tuple, J)), offset=(0.1, 0.2, -0.1)),
    )
    w = np.array([0.5, -0.7, 0.9])
    x = tree.state(base_rate_x=w[0], base_rate_y=w[1], base_rate_z=w[2])
    dx, c = tree.dynamics(x), np.array([0.1, 0.2, -0.1])
    alpha = np.linalg.solve(J, -np.cross(w, J @ w))
    np.testing.assert_allclose(dx[10:], alpha, atol=1e-12)
    fall = dx[7:10] + np.cross(alpha, c) + np.cross(w, np.cross(w, c))
    np.testing.assert_allclose(fall, [0, 0, -9.81], atol=1e-12)


def test_what_is_fixed_to_the_base_is_the_base():
    hub = TreeBody(name="hub", joint=Joint(name="hub", kind="fixed"), mass=4.0, inertia=0.6)
    on_hub = [dataclasses.replace(ARM[0], parent="hub"), ARM[1]]
    made = [
        FlexibleTree(bodies=(hub, *on_hub), base="free"),
        FlexibleTree(bodies=tuple(ARM), base="free", platform=Payload(mass=4.0, inertia=0.6)),
    ]
    x = made[0].consistent(np.random.default_rng(0).uniform(-1, 1, made[0].nx))
    np.testing.assert_allclose(made[0].dynamics(x, [0.1, 0.2]), made[1].dynamics(x, [0.1, 0.2]), atol=1e-12)

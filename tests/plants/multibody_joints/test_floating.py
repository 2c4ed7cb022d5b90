"""A free-floating arm reaches the angles that it is sent to, its base turning back."""

import numpy as np
import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody


@pytest.mark.parametrize("gravity", [(0, 0, 0), (0.5, -1.0, -2.0)])
def test_joints_arrive_and_the_base_turns_back(gravity):
    bodies = [
        TreeBody(name="a", joint=Joint(name="a", position=(0.3, 0, 0)), mass=1.0, centre=(0.5, 0, 0), inertia=0.1),
        TreeBody(
            name="b",
            joint=Joint(name="b", axis=(0, 0.6, 0.8), position=(1, 0, 0)),
            mass=1.0,
            centre=(0.5, 0, 0),
            inertia=0.1,
        ),
    ]
    tree = FlexibleTree.serial(bodies, base="free", platform=Payload(mass=10.0, inertia=1.5), gravity=gravity)
    begin, end = tree.state(a=0.1), tree.state(a=0.9, b=-0.6)
    u = tree.rest_to_rest(begin, end, 2.0)
    motion = tree.simulate(begin, u, np.linspace(0, 2, 5))
    np.testing.assert_allclose([motion["a"][-1], motion["b"][-1]], [0.9, -0.6], atol=1e-8)
    np.testing.assert_allclose([motion["a_rate"][-1], motion["b_rate"][-1]], 0.0, atol=1e-8)
    assert motion["base_attitude_z"][-1] < -0.05
    assert u(3.0).shape == (2,)

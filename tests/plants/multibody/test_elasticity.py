"""Stops, springs and elastic gears of single joints."""

import numpy as np

from pliant.plants import ElasticJoint, FlexibleTree, Joint, TreeBody


def test_stops_hold():
    """Well beyond a limit a spring of that stiffness, half-way nothing; the energies agree with the forces."""
    stop = {"lower": -0.5, "upper": 1.0, "stop_stiffness": 100.0}
    tree = FlexibleTree.serial([TreeBody(name="a", joint=Joint(name="a", **stop), inertia=2.0)], gravity=(0, 0, 0))
    np.testing.assert_allclose(tree.dynamics([1.2, 0.0])[1], -100.0 * 0.2 / 2.0, rtol=2e-3)
    np.testing.assert_allclose(tree.dynamics([-0.7, 0.0])[1], 100.0 * 0.2 / 2.0, rtol=2e-3)
    assert abs(tree.dynamics([0.25, 0.0])[1]) < 1e-6
    h = 1e-5
    for q in (1.0, -0.5, 1.1):
        slope = (tree.potential([q + h, 0.0]) - tree.potential([q - h, 0.0])) / (2 * h)
        np.testing.assert_allclose(-2.0 * tree.dynamics([q, 0.0])[1], slope, rtol=1e-6)
    assert tree.potential([0.0, 0.0]) == 0.0


def test_elastic_joint_has_its_closed_form_frequency():
    """omega^2 = k (1/J + 1/(N^2 J_m)): two inertias on a spring, the rotor's N^2 J_m at the joint (Spong, 1987)."""
    gear = ElasticJoint(stiffness=800.0, ratio=50.0, rotor_inertia=2e-5)
    body = TreeBody(name="arm", joint=Joint(name="hub", elastic=gear), inertia=0.3)
    tree = FlexibleTree.serial([body], gravity=(0, 0, 0))
    closed = np.sqrt(800.0 * (1 / 0.3 + 1 / (50.0**2 * 2e-5)))
    np.testing.assert_allclose(tree.natural_frequencies(), [closed], rtol=1e-10)
    assert [s.name for s in tree.states] == ["hub", "hub_motor", "hub_rate", "hub_motor_rate"]
    assert tree.joints[0].position == "hub_motor"
    rate = tree.dynamics([0.0, 0.5, 0.0, 0.0], [0.0])  # the spring turns by 0.5/50
    np.testing.assert_allclose(rate[2:], [8.0 / 0.3, -8.0 / 50.0 / 2e-5])

"""What a plant with quaternions says of itself, and what its motions keep."""

import dataclasses

import numpy as np
import pytest
from moved_states import moved

from pliant.plants import FlexibleTree, Joint, TreeBody


def test_names(craft):
    assert [s.name for s in craft.coordinates][:8] == [
        *("base_x", "base_y", "base_z"),
        *(f"base_quaternion_{k}" for k in range(4)),
        "arm",
    ]
    assert [s.name for s in craft.speeds][:7] == [
        *("base_x_rate", "base_y_rate", "base_z_rate", "base_rate_x", "base_rate_y", "base_rate_z", "arm_rate")
    ]
    assert craft.rates == {"base_x": "base_x_rate", "base_y": "base_y_rate", "base_z": "base_z_rate", "arm": "arm_rate"}
    assert craft.attitude_states[4] == "ball_quaternion_0"
    assert set(craft.attitude_outputs) <= {s.name for s in craft.outputs}
    assert craft.lockable == ("arm",)
    assert craft.unfelt.groups[0] == ("base_x", "base_y", "base_z")
    assert {"base_turn_x_rate", "base_rate_x", "arm_rate"} <= set(craft.velocities)


def test_quaternions_keep_their_length(craft):
    motion = craft.simulate(moved(craft, 0), [0.5], np.linspace(0, 2, 9))
    for a in craft.attitudes:
        np.testing.assert_allclose(np.linalg.norm(motion.x[:, a.quaternion], axis=1), 1.0, atol=1e-9)


def test_jacobians_from_the_balance_of_forces(craft):
    """Of equations as they stand, along unit vectors, against the model of the solved ones: the same along a motion,
    and at accelerations that are not the plant's own.
    """
    motion = craft.simulate(moved(craft, 1, 0.5), [0.3], np.linspace(0, 0.2, 5))
    for nominal in (motion, dataclasses.replace(motion, dx=motion.derivative() + 0.3)):
        A = craft.linearize_along(nominal, attitude="quaternion").A
        np.testing.assert_allclose(craft.state_jacobians_along(nominal), A, atol=1e-11 * np.abs(A).max())
    rates = craft.force_balance.rates(motion.x)
    np.testing.assert_allclose(rates, craft.dynamics(motion.x, [0.3])[:, : len(craft.coordinates)], atol=1e-14)


def test_states_are_checked(craft):
    x = craft.state(arm=0.2)
    x[3] = 1.1
    with pytest.raises(ValueError, match=r"the quaternion of 'base' has norm 1\.1, must be 1; see `state`"):
        craft.simulate(x, None, [0, 1])
    np.testing.assert_array_equal(craft.consistent(x), craft.state(arm=0.2))
    with pytest.raises(ValueError, match=r"FlexibleTree\.x has shape \(3,\), must be \(\.\.\., 22\)"):
        craft.consistent(np.zeros(3))
    with pytest.raises(ValueError, match="state 'leg' must be one of"):
        craft.state(leg=1.0)


def test_equilibrium_holds_a_free_base(craft):
    x0, u0 = craft.equilibrium(arm=0.3, base_x=1.0)
    np.testing.assert_allclose(x0, craft.state(arm=0.3, base_x=1.0), atol=1e-12)
    np.testing.assert_allclose(u0, 0.0, atol=1e-12)


def test_given_motion(pendulum):
    tree = FlexibleTree.serial(
        [TreeBody(name="b", joint=Joint(name="b", kind="spherical", drive="acceleration"), mass=1.0, inertia=0.1)]
    )
    assert tree.prescribed == tuple(f"b_quaternion_{k}" for k in range(4))
    np.testing.assert_array_equal(tree.dynamics(tree.rest_state, [1.0, 2.0, 3.0])[4:], [1, 2, 3])
    assert pendulum.prescribed == ()


def test_without_quaternions_nothing_changes():
    tree = FlexibleTree.serial([TreeBody(name="b", joint=Joint(name="b"), mass=1.0, inertia=0.1)])
    assert tree.attitudes == ()
    assert tree.deviations == tree.states
    assert tree.linearize(np.zeros(2)).A.shape == (2, 2)
    assert not tree.unfelt.groups
